"""``gymnasium.make("PlumeCrossing-v0")``: flights as an environment for reinforcement learning. Needs the extra ``gym``.

The installed project announces it to gymnasium by an entry point; without one, call ``register_environment``.
"""

ENVIRONMENT = "PlumeCrossing-v0"


def register_environment() -> None:
    """Make the environment known to gymnasium, which calls this by its entry point."""
    from gymnasium.envs.registration import register, registry

    if ENVIRONMENT not in registry:
        register(ENVIRONMENT, entry_point="scenarios.gym.environment:PlumeCrossing")
