"""``gymnasium.make("PlumeCrossing-v0")``: flights as an environment for reinforcement learning.
Needs the extra ``gym``.

Importing this package registers the environment, because gymnasium has no entry points since its
version 1.0. The user imports it, or ``gymnasium.make("extensions.gym:PlumeCrossing-v0")`` does.
"""

from common.text import install_words

try:
    from gymnasium.envs.registration import register, registry
except ModuleNotFoundError as error:
    if (error.name or "").partition(".")[0] != "gymnasium":
        raise
    raise ImportError(
        f"extensions.gym needs gymnasium; install the extra: {install_words('gym')}",
        name="gymnasium",
    ) from None

ENVIRONMENT = "PlumeCrossing-v0"

if ENVIRONMENT not in registry:
    register(ENVIRONMENT, entry_point="extensions.gym.environment:PlumeCrossing")
