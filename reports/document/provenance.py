"""Where a run comes from: how it was made, its source and input, its software, and the kind of
host.
"""

from common.provenance import without_folders
from reports.document.blocks import Section
from reports.document.tables import pairs_table, run_config
from reports.run.letterhead import Letterhead
from reports.run.run_data import RunData

_SHORTENED = ": the first 16 digits of the SHA-256"
"""Which hash a hash is."""


def provenance_section(run: RunData, head: Letterhead) -> Section:
    """Return the last section of a report."""
    rows = [
        row for rows in (_made(run, head), _vehicle(run), _hashes(run), _host(run)) for row in rows
    ]
    caption = "How the run was made; with the same source, input and seed it can be made again."
    table = pairs_table(rows, caption=caption, breakable=True, print_size_pt=6.0)
    return Section(anchor="provenance", title="Provenance", blocks=[table])


def _made(run: RunData, head: Letterhead) -> list[list[str]]:
    manifest = run.manifest
    study = manifest.get("study")
    of = {"design": "Design", "measurement": "Flight"}.get(str(study), "Scenario")
    rows = [
        [of, f"{manifest['name']}: {manifest['title']}"],
        ["Command", manifest.get("command") or "not recorded: a program made the run"],
        [
            "Changed for this run",
            ", ".join(map(without_folders, manifest["overrides"])) or "nothing",
        ],
        ["Analysed" if study == "measurement" else "Began", head.when],
        ["State", manifest["state"]],
    ]
    if "wall_time_s" in manifest:
        used = [f"{manifest['wall_time_s']:.1f} s"]
        if "peak_memory_mib" in manifest:
            used.append(f"up to {manifest['peak_memory_mib']:.0f} MiB in a process")
        rows.append(["Duration", ", ".join(used)])
    return rows


def _hashes(run: RunData) -> list[list[str]]:
    manifest = run.manifest
    measured = manifest.get("study") == "measurement"
    seed = manifest["config"].get("seed")
    rows = [["Source revision", manifest["git_revision"]]]
    if source := manifest.get("fingerprint", {}).get("source"):
        rows.append(
            ["Hash of the source", f"{source}, of the program's files and presets{_SHORTENED}"]
        )
    if measured:
        files = {"log": (manifest["source"], manifest["source_hash"])}
        files |= (
            {"configuration": (manifest["settings"], manifest["settings_hash"])}
            if manifest["settings"]
            else {}
        )
        rows += [
            [f"SHA-256 of the {what}", f"{digest}, of the file {name}"]
            for what, (name, digest) in files.items()
        ]
    # A design is made without chance, and of no more than its title says.
    elif manifest.get("study") != "design":
        rows.append(
            [
                "Hash of the scenario",
                f"{manifest['config_hash']}, of its keys and files{_SHORTENED}",
            ]
        )
        rows.append(["Seed", "each trial's own" if seed is None else str(seed)])
    if logo := manifest.get("report", {}).get("logo_sha256"):
        rows.append(["Hash of the logo", f"{logo[:16]}, of the file{_SHORTENED}"])
    return rows


def _vehicle(run: RunData) -> list[list[str]]:
    config = run_config(run)
    rows = []
    if run.innerloop:
        rows.append(["Aircraft", f"{run.innerloop['title']}. {run.innerloop['source']}"])
    elif (
        config.get("fidelity", "six_dof") == "six_dof"
        and run.manifest.get("study") != "measurement"
    ):
        rows.append(["Aircraft", str(config.get("aircraft", "unknown"))])
    if config.get("fidelity") in ("kinematic", "both"):
        words = (
            "Equation (1) of the paper: it has the commanded speed at once, and is steered by its"
            " heading rate."
        )
        rows.append(["Kinematic vehicle", words])
    return rows


def _host(run: RunData) -> list[list[str]]:
    manifest = run.manifest
    cores = manifest.get("cores")
    return [
        ["Host", manifest["platform"] + (f", {cores} cores" if cores else "")],
        [
            "Software",
            ", ".join(
                f"{name} {version}"
                for name, version in {"Python": manifest["python"], **manifest["packages"]}.items()
            ),
        ],
        ["Format of the run", str(manifest["format"])],
    ]
