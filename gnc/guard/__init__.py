"""The keep-out guard: the filter of commands, and the prediction of a turn that it decides by."""
