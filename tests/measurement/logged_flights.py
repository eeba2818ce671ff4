"""The command on a logged flight."""

from measurement.log.command import main


def run(logged, *more, config=True):
    with_config = ["--config", str(logged.parent / "instrument.toml")] if config else []
    return main(
        [str(logged), "--out", str(logged.parent / "out"), "--no-report", *with_config, *more]
    )
