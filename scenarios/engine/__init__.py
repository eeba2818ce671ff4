"""What flies the studies: work, executors that do it, the journal of what is done. It knows no study."""
