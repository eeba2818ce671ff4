"""Optional packages of the project, and how they are installed."""


def install_words(extra: str) -> str:
    """Return how an extra of the project is installed, for messages: into a clone that stays
    editable, in pinned versions.
    """
    return f"in the clone, pip install -c constraints.txt -e '.[{extra}]'"
