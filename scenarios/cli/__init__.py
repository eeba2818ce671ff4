"""The console command ``plume-flight``: every command line of the project by one name, and what is
known of the keys.
"""
