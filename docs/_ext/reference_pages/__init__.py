"""Pages of the reference that are made from the program itself, each a function that returns
Markdown.
"""
