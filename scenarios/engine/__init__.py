"""Execute the tasks of a study in many processes, and store every result as it arrives."""
