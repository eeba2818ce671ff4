"""The linear aircraft without its servos and engines: what gains are computed from."""

from collections.abc import Sequence

import control
import numpy as np
import numpy.typing as npt

from aircraft.dynamics.linearise import BODY_STATES

_MOVES = 1e-9
"""Final value below which a state does not follow an input: a rate comes back to zero."""

Matrix = npt.NDArray[np.float64]


def quasi_static(model: control.StateSpace) -> control.StateSpace:
    """Return the model with every state that follows an input replaced by its static gain."""
    labels: Sequence[str] = model.state_labels
    rigid = [i for i, name in enumerate(labels) if name in BODY_STATES]
    driven = [i for i, name in enumerate(labels) if name not in BODY_STATES]
    a, b, c, d = model.A, model.B, model.C, model.D
    inverse = -np.linalg.inv(a[np.ix_(driven, driven)])
    by_rigid, by_input = inverse @ a[np.ix_(driven, rigid)], inverse @ b[driven]
    return control.ss(
        a[np.ix_(rigid, rigid)] + a[np.ix_(rigid, driven)] @ by_rigid,
        b[rigid] + a[np.ix_(rigid, driven)] @ by_input,
        c[:, rigid] + c[:, driven] @ by_rigid,
        d + c[:, driven] @ by_input,
        states=[labels[i] for i in rigid],
        inputs=model.input_labels,
        outputs=model.output_labels,
    )


def state_lag(model: control.StateSpace, control_input: str) -> float:
    """Return the lag of a control input [s]: the area above the step response of the slowest state that follows it."""
    driven = [i for i, name in enumerate(model.state_labels) if name not in BODY_STATES]
    if not driven:
        return 0.0
    follow = model.A[np.ix_(driven, driven)]
    end = -np.linalg.solve(follow, model.B[driven, model.input_labels.index(control_input)])
    area = -np.linalg.solve(follow, end)
    return max((float(a / e) for a, e in zip(area, end, strict=True) if abs(e) > _MOVES), default=0.0)


def pick(plant: control.StateSpace, states: Sequence[str], inputs: Sequence[str], outputs: Sequence[str]) -> tuple[Matrix, ...]:
    """Return A, B, C and D of the named states, inputs and outputs, all else at rest."""
    rows = [plant.state_labels.index(name) for name in states]
    columns = [plant.input_labels.index(name) for name in inputs]
    reads = [plant.output_labels.index(name) for name in outputs]
    return (
        plant.A[np.ix_(rows, rows)],
        plant.B[np.ix_(rows, columns)],
        plant.C[np.ix_(reads, rows)],
        plant.D[np.ix_(reads, columns)],
    )
