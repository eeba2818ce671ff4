"""What flies the studies: work, crews that do it, the journal of what is done. It knows no study."""
