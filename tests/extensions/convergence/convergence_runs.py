"""Run directories as a convergence study leaves them, with plausible numbers from a seeded
generator instead of trajectories.
"""

import json

import numpy as np
import pandas as pd

LAWS = ("lyapunov", "cascade", "cascade_cut")
REFERENCES = ("circle", "oscillation", "random")
SPEED = 19.42
SAMPLES = 6
TRAJECTORIES = 1200
"""Of each law, in the studies that several tests read."""


def write_convergence_run(
    path,
    trajectories,
    *,
    seed=1,
    failures=(),
    cut_failures=0,
    state="complete",
    planned=None,
    samples=1,
):
    """Write a run directory, with the time histories of the first ``samples`` trajectories and of
    those that failed.

    ``failures`` are (law, trajectory, outcome); ``cut_failures`` so many more under the cut law,
    which run out of time.
    """
    rng = np.random.default_rng(seed)
    rows = pd.concat([law_rows(law, trajectories, rng) for law in LAWS], ignore_index=True)
    cut = [
        ("cascade_cut", int(i), "time_up")
        for i in rng.choice(trajectories, cut_failures, replace=False)
    ]
    for law, trajectory, outcome in [*failures, *cut]:
        fail(rows, (rows["law"] == law) & (rows["trajectory"] == trajectory), outcome)
    failed = rows[rows["outcome"] != "converged"]
    (path / "trajectories").mkdir(parents=True)
    rows.to_csv(path / "summary.csv", index=False)
    failed.to_csv(path / "counterexamples.csv", index=False)
    kept = pd.concat([rows[rows["trajectory"] < samples], failed]).drop_duplicates(
        ["law", "trajectory"]
    )
    for _, row in kept.iterrows():
        history(row).to_parquet(
            path / "trajectories" / f"{row['law']}_{row['trajectory']:05d}.parquet"
        )
    text = json.dumps(manifest(planned or trajectories, seed, state))
    (path / "manifest.json").write_text(text, encoding="utf-8")
    return path


def law_rows(law, count, rng):
    # The starts are those of every law, and so are drawn alike.
    starts = np.random.default_rng(0)
    distance = 5000.0 * np.sqrt(starts.uniform(size=count))
    bearing, course, reference_course = starts.uniform(-np.pi, np.pi, (3, count))
    phi = starts.uniform(-np.pi, np.pi, count)
    kind = np.arange(count) % 3
    predicted = distance * np.array([0.9, 1.0, 1.2])[kind]
    # As a trial with extensions.convergence.ensemble: medians near a second per metre, a long tail about
    # references that turn at random. They end at 20,000 s at the latest.
    settling = np.minimum(
        predicted * rng.lognormal(0.0, np.array([0.2, 0.25, 0.35])[kind]), 19_000.0
    )
    command = {
        "lyapunov": 0.5 / np.maximum(np.abs(np.pi - np.abs(phi)), 1e-5),
        "cascade": 0.4 + rng.exponential(0.6, count),
        "cascade_cut": np.full(count, 0.503),
    }[law]
    return pd.DataFrame({
        "trajectory": np.arange(count),
        "law": law,
        "reference": np.array(REFERENCES)[kind],
        "reference_heading_rate_max_rad_s": starts.uniform(0.05, 0.45, count),
        "start_north_m": distance * np.cos(bearing),
        "start_east_m": distance * np.sin(bearing),
        "start_distance_m": distance,
        "start_course_rad": course,
        "reference_course_rad": reference_course,
        "start_phi_rad": phi,
        "outcome": "converged",
        "message": "on the reference",
        "settling_time_s": settling,
        "settling_time_predicted_s": predicted,
        "distance_final_m": 0.02 * rng.uniform(size=count),
        "phi_final_rad": 2e-4 * rng.uniform(-1.0, 1.0, count),
        "duration_s": settling + 300.0,
        "distance_max_m": distance * (1.0 + 0.05 * rng.uniform(size=count)),
        "heading_rate_max_rad_s": command,
        "reference_terms": np.array(["0.3", "0.45 sin(0.3 t + 1)", "0.2 sin(0.1 t), 0.1 sin(0.3 t)"])[kind],
    })  # fmt: skip


def fail(rows, chosen, outcome):
    finite = outcome != "not_finite"
    rows.loc[chosen, "outcome"] = outcome
    rows.loc[chosen, "message"] = (
        "812.3 m from the reference after 20000 s, phi 0.31 rad: raise time_max"
        if finite
        else "the step from there is not finite"
    )
    rows.loc[chosen, "settling_time_s"] = np.nan
    rows.loc[chosen, "distance_final_m"] = 812.3 if finite else np.nan
    rows.loc[chosen, "phi_final_rad"] = 0.31 if finite else np.nan
    rows.loc[chosen, "duration_s"] = 20_000.0


def history(row):
    time = np.linspace(0.0, row["duration_s"], 2500)
    converged = row["outcome"] == "converged"
    reach = row["settling_time_s"] if converged else 1e6
    # A straight way in and then an exponential end, as z shrinks.
    distance = row["start_distance_m"] * np.maximum(1.0 - time / reach, 0.0) + 5.0 * np.exp(
        -np.maximum(time - reach, 0.0) / 50.0
    )
    angle = 0.3 * time
    return pd.DataFrame({
        "time_s": time,
        "distance_m": distance,
        "phi_rad": row["start_phi_rad"] * np.exp(-time),
        "phi_r_rad": 0.5 * np.sin(angle),
        "heading_rate_rad_s": 0.3 + 0.1 * np.sin(angle),
        "north_m": 60.0 * np.sin(angle) + distance,
        "east_m": -60.0 * np.cos(angle),
        "reference_north_m": 60.0 * np.sin(angle),
        "reference_east_m": -60.0 * np.cos(angle),
    })  # fmt: skip


def manifest(planned, seed, state):
    ensemble = {"trajectories": planned, "distance_max_m": 5000.0, "settling_band_m": 5.0}
    guidance = {"laws": list(LAWS), "airspeed_mps": SPEED, "heading_rate_max_rad_s": 0.503}
    parameters = [
        {
            "key": "ensemble.trajectories",
            "value": planned,
            "unit": "",
            "meaning": "Initial states, each flown with every law.",
        },
        {
            "key": "ensemble.distance_max_m",
            "value": 5000.0,
            "unit": "m",
            "meaning": "Farthest start from the reference.",
        },
        {
            "key": "guidance.laws",
            "value": list(LAWS),
            "unit": "",
            "meaning": "Eq. (24); eq. (30); eq. (30) cut at omega_max.",
        },
    ]
    return {
        "format": 1,
        "name": "convergence",
        "study": "convergence",
        "converged_distance_m": 0.02,
        "converged_phi_rad": 2e-4,
        "title": "Global convergence, measured",
        "config": {
            "study": "convergence",
            "description": "Random initial states about circling, oscillating and randomly turning references.",
            "seed": seed,
            "ensemble": ensemble,
            "guidance": guidance,
        },
        "parameters": parameters,
        "overrides": [],
        "state": state,
        "config_hash": "0123456789abcdef",
        "git_revision": "ba78b23",
        "packages": {"numpy": "2.0"},
        "python": "3.11",
        "platform": "Linux x86_64",
        "wall_time_s": 12.5,
    }
