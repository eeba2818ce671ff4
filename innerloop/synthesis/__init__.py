"""From linear models to scheduled LQR gains."""
