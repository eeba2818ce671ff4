"""What page 1 says first: that a run was interrupted, or that something is missing."""


def state_words(
    what: str,
    done: int,
    planned: int,
    *,
    is_done: bool,
    interrupted: bool,
    missing: str = "its end",
) -> list[str]:
    """Return the state of a run as the first sentence of its headline; nothing where all is done.

    Parameters
    ----------
    what : name of the items that are counted, in the plural
    done, planned : numbers of items
    is_done : whether everything that was planned is done
    interrupted : whether the run ended before
    missing : what is, where all items are done
    """
    if is_done:
        return []
    word = "INTERRUPTED" if interrupted else "INCOMPLETE"
    if done == planned:
        return [f"{word} before {missing}"]
    return [f"{word} after {done:,} of {planned:,} {what}"]
