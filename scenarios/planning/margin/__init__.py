"""The keep-out margin, predicted from spectra."""
