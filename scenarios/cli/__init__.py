"""The console command ``plume-flight``: every command line of the project under one name, and the
description of the keys.
"""
