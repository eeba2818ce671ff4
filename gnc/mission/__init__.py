"""What to do now: approach, track, hold off, leave."""
