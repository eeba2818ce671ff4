"""An estimate of the fuel sulphur content, its figures, and its record for JSON."""

import math
from dataclasses import asdict, dataclass, field
from typing import Any, Literal

import pandas as pd

from measurement.estimate.passes import Pass
from measurement.estimate.verdict import Verdict
from measurement.sniffer.spec import SnifferSpec

Method = Literal["regression", "areas"]
Quality = Literal["A", "B", "C"]


@dataclass(frozen=True, kw_only=True)
class Figures:
    """Figures of a record.

    Attributes
    ----------
    duration_s : of the record [s]
    passes : number of passes through the plume
    interval_s : between passes, median [s]
    seconds_in_plume : time with the CO2 reading above its background by its detection limit [s]
    dose_ppm_s : CO2 of a pass, mean [ppm s]
    co2_snr : signal to noise of a pass's peak, median [-]
    so2_snr : standard deviation of the SO2 that the plume explains, over that of the remainder [-]
    background_ppm, background_ppb : standard deviation of the varying background of CO2, and of SO2
        without the plume
    background_s : correlation length of that background [s]
    passes_excluded : number of passes of another fuel
    """

    duration_s: float
    passes: int
    interval_s: float
    seconds_in_plume: float
    dose_ppm_s: float
    co2_snr: float
    so2_snr: float
    background_ppm: float
    background_ppb: float
    background_s: float
    passes_excluded: int


@dataclass(frozen=True, kw_only=True)
class PassContent:
    """Sulphur content from a single pass, and its noise [% m/m]; the time of the pass's peak
    [s].
    """

    time_s: float
    fsc_percent: float
    noise_percent: float


@dataclass(frozen=True, kw_only=True)
class FscEstimate:
    """A fuel sulphur content with its uncertainty, in % m/m; NaN where it is unknown.

    Attributes
    ----------
    method : "regression" or "areas"
    fsc_percent : estimate; noise may make it negative
    noise_percent : standard uncertainty by noise, which falls with the number of passes
    common_percent : standard uncertainties by errors that do not average out, by name
    overlap_percent : increase of the result if the areas' passes did not overlap; 0 by regression
    assumed_percent : part of the estimate that corrects SO2 for unmeasured NO and NO2, by the mean
        emissions of ships
    total_percent : standard uncertainty by noise and common errors
    low_percent, high_percent : 95 % interval, from the same distribution as the verdicts'
        probabilities
    sulphate_percent : mean error by sulphur that is emitted as sulphate, stated and not corrected
    slope_ppb_per_ppm : SO2 over CO2
    misfit : mean square of the residuals over that of the stated noise [-]
    quality, quality_reasons : A, B or C, and why it is not A
    verdicts : on each limit
    figures : of the record
    passes : through the plume
    excluded : passes of another fuel, such as that of another ship
    pass_percent, pass_deviation_percent : sulphur content of groups of neighbouring passes and its
        noise
    agreement : probability that passes of one fuel differ as much as these
    so2_t90_s, so2_t90_sd_s, delay_s, delay_sd_s : response of SO2 and its delay after CO2, as
        stated or fitted [s]
    instrument : as used: the record gives noise, and response and delay of SO2, where they were not
        stated
    signals : readings, equalised signals without their background, fit and residual; a row per
        sample
    """

    method: Method
    fsc_percent: float
    noise_percent: float
    common_percent: dict[str, float]
    overlap_percent: float
    assumed_percent: float
    total_percent: float
    low_percent: float
    high_percent: float
    sulphate_percent: float
    slope_ppb_per_ppm: float
    misfit: float
    quality: Quality
    quality_reasons: tuple[str, ...]
    verdicts: tuple[Verdict, ...]
    figures: Figures
    passes: tuple[Pass, ...]
    excluded: tuple[PassContent, ...]
    pass_percent: tuple[float, ...]
    pass_deviation_percent: tuple[float, ...]
    agreement: float
    so2_t90_s: float
    so2_t90_sd_s: float
    delay_s: float
    delay_sd_s: float
    instrument: SnifferSpec = field(repr=False)
    signals: pd.DataFrame = field(compare=False, repr=False)

    def record(self) -> dict[str, Any]:
        """Return everything but instrument and signals, for JSON, with None for NaN."""
        names = [name for name in vars(self) if name not in ("instrument", "signals")]
        values = {name: getattr(self, name) for name in names}
        values["figures"] = asdict(self.figures)
        values["verdicts"] = [verdict.percent_record() for verdict in self.verdicts]
        values["passes"] = [asdict(found) for found in self.passes]
        values["excluded"] = [asdict(found) for found in self.excluded]
        return {name: plain(value) for name, value in values.items()}


def plain(value: Any) -> Any:
    """Return a value for JSON, with None for each number in it that is not finite."""
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, dict):
        return {name: plain(item) for name, item in value.items()}
    return [plain(item) for item in value] if isinstance(value, (list, tuple)) else value
