"""From a record to figures and criteria."""
