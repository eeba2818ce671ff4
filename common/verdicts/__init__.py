"""How runs are judged whose verdict is worked out in a study and shown in a report."""
