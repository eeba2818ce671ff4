"""The linear aircraft without its servos and engines: what gains are computed from."""

import numpy as np

from aircraft.linearise import BODY_STATES, LinearModel

_MOVES = 1e-9
"""Final value below which a state does not follow an input: a rate comes back to zero."""


def quasi_static(model: LinearModel) -> LinearModel:
    """Return the model with every state that follows an input replaced by its static gain."""
    labels = model.state_labels
    rigid = [i for i, name in enumerate(labels) if name in BODY_STATES]
    driven = [i for i, name in enumerate(labels) if name not in BODY_STATES]
    a, b, c, d = model.A, model.B, model.C, model.D
    inverse = -np.linalg.inv(a[np.ix_(driven, driven)])
    by_rigid, by_input = inverse @ a[np.ix_(driven, rigid)], inverse @ b[driven]
    return LinearModel(
        A=a[np.ix_(rigid, rigid)] + a[np.ix_(rigid, driven)] @ by_rigid,
        B=b[rigid] + a[np.ix_(rigid, driven)] @ by_input,
        C=c[:, rigid] + c[:, driven] @ by_rigid,
        D=d + c[:, driven] @ by_input,
        state_labels=tuple(labels[i] for i in rigid),
        input_labels=model.input_labels,
        output_labels=model.output_labels,
    )


def state_lag(model: LinearModel, control_input: str) -> float:
    """Return the lag of a control input [s]: the area above the step response of the slowest state
    that follows it.
    """
    driven = [i for i, name in enumerate(model.state_labels) if name not in BODY_STATES]
    if not driven:
        return 0.0
    follow = model.A[np.ix_(driven, driven)]
    end = -np.linalg.solve(follow, model.B[driven, model.input_labels.index(control_input)])
    area = -np.linalg.solve(follow, end)
    return max(
        (float(a / e) for a, e in zip(area, end, strict=True) if abs(e) > _MOVES), default=0.0
    )
