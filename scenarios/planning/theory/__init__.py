"""What theory says over the speed ratio."""
