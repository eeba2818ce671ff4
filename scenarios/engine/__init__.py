"""Executes the tasks of a study in many processes, and keeps every result on disk as it arrives."""

from scenarios.engine.executors import ExecutorFactory
from scenarios.engine.journal import Journal
from scenarios.engine.run_directory import RunDirectory
from scenarios.engine.runner import RunResult, Study, StudySummary, fly_study
from scenarios.engine.task import Limits, Result, Row, Task, Work

__all__ = [
    "ExecutorFactory",
    "Journal",
    "Limits",
    "Result",
    "Row",
    "RunDirectory",
    "RunResult",
    "Study",
    "StudySummary",
    "Task",
    "Work",
    "fly_study",
]
