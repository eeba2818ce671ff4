"""What is not the mission: each folder adds capabilities through the doors that a user's package
has.

An extension holds its code, its report, its catalog files (``catalog/NAME.toml``) and its page of
documentation (``page.md``). Nothing else imports it: the program finds it by entry points of
``pyproject.toml`` in the groups ``plume_flight_study.KIND``, which
``docs/howto/extending.md`` lists.
"""
