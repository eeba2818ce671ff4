"""What a sniffer read in the exports for globes and maps, read back."""

import json
import math
import zipfile
from pathlib import Path

import pytest

from tests.reports.export.placed_flight import READ, assert_read, exported


def test_kmz_has_an_array_of_readings_beside_the_track_and_is_valid(sniffed):
    from lxml import etree

    schemas = (
        Path(pytest.importorskip("fastkml", reason="it brings the schema").__file__).parent
        / "schema"
    )
    with zipfile.ZipFile(exported(sniffed, "kmz")) as archive:
        root = etree.fromstring(archive.read("doc.kml"))
    names = {"k": "http://www.opengis.net/kml/2.2", "gx": "http://www.google.com/kml/ext/2.2"}
    whole = etree.XMLSchema(etree.parse(schemas / "kml22gx.xsd"))
    assert whole.validate(root), whole.error_log
    fields = {
        field.get("name"): field.find("k:displayName", names).text
        for field in root.iter(f"{{{names['gx']}}}SimpleArrayField")
    }
    assert fields == {
        "so2_reading_ppb": "SO2 reading [ppb]", "co2_reading_ppm": "CO2 reading [ppm]", "no_reading_ppb": "NO reading [ppb]",
    }  # fmt: skip
    uav, vessel = root.findall(".//gx:Track", names)
    (data,) = uav.findall(".//k:SchemaData", names)
    (schema,) = root.findall(".//k:Schema", names)
    assert data.get("schemaUrl") == f"#{schema.get('id')}"
    arrays = {array.get("name"): [value.text or "nan" for value in array] for array in data}
    assert set(arrays) == set(READ)
    for name, values in arrays.items():
        assert len(values) == len(uav.findall("k:when", names))
        assert_read(values, name)
    assert vessel.find("k:ExtendedData", names) is None


def test_geojson_has_an_array_of_readings_for_the_times_of_the_track(sniffed):
    collection = json.loads(exported(sniffed, "geojson").read_text(encoding="utf-8"))
    by_what = {
        feature["properties"]["what"]: feature["properties"] for feature in collection["features"]
    }
    for name in READ:
        assert len(by_what["uav"][name]) == len(by_what["uav"]["times_s"])
        # Null where there is no reading: JSON has no number for it.
        assert by_what["uav"][name][0] is None
        assert_read([math.nan if value is None else value for value in by_what["uav"][name]], name)
    assert not {key for key in (*by_what["uav"], *by_what["vessel"]) if "reading" in key} - set(
        READ
    )
