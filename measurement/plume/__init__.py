"""The plume behind a stack over the sea: rise, spread, meander and concentration."""
