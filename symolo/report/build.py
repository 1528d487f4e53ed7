"""The page of a release, from its folder alone: the same bytes for the same release."""

from symolo.core.progress import Report
from symolo.pages.thumbnails import thumbnail
from symolo.reader.dataset import Dataset
from symolo.report.camera_rows import camera_rows
from symolo.report.media import Media
from symolo.report.page import MAX_OUTLIERS, page
from symolo.report.state_sheets import images_of_states
from symolo.report.statistics.facts import ReleaseFacts, release_facts
from symolo.report.statistics.maps import route_maps
from symolo.report.statistics.spread import spread

MAX_MAPS = 12
MAX_SPREAD_RUNS = 40
"""Runs with a row in the plot of brightness, clipping and sharpness."""


def release_report(data: Dataset, max_detailed: int, report: Report) -> bytes:
    """Return the page, encoded.

    Args:
        data: A release, or some of its runs, whose checksums hold.
        max_detailed: At most this number of runs is shown in detail.
        report: Receiver of the progress.

    Raises:
        InputError: A file of the release is not what it should be.
    """
    if data.metadata is None:
        raise ValueError("a run alone has no metadata")
    facts = release_facts(data, data.metadata, max_detailed, report)
    return page(facts, _media(data, facts, report)).encode()


def _media(data: Dataset, facts: ReleaseFacts, report: Report) -> Media:
    # Matplotlib takes half a second to load, so it is imported only after the facts have turned out to be sound.
    from symolo.report.plots.brightness import brightness_plot, spread_plot  # noqa: PLC0415
    from symolo.report.plots.map import map_plot  # noqa: PLC0415
    from symolo.report.plots.run import run_plot  # noqa: PLC0415
    from symolo.report.plots.scans import scan_plot  # noqa: PLC0415
    from symolo.report.plots.sensor import sensor_plot  # noqa: PLC0415

    facts_by_run = {run.record.run: run for run in facts.runs}
    maps = route_maps(facts.runs)
    shown_maps = spread(maps, MAX_MAPS)
    state_sheets = images_of_states(facts.runs)
    spread_runs = spread(facts.images, MAX_SPREAD_RUNS)
    runs = {}
    with report.stage("plots", len(facts.detailed), "runs") as stage:
        for done, name in enumerate(facts.detailed, start=1):
            runs[name] = run_plot(data[name], facts_by_run[name])
            stage.update("all", done)
    sensor_run = data[facts.detailed[0]] if facts.detailed else data.runs[0]
    images = {(image.run, image.number) for images in state_sheets.values() for image in images}
    images |= {(group.run, group.worst) for group in facts.outliers[:MAX_OUTLIERS]}
    return Media(
        maps=tuple(map_plot(one) for one in shown_maps),
        map_count=len(maps),
        runs=runs,
        sensors={table.name: sensor_plot(sensor_run, table) for table in sensor_run.sensor_tables},
        scans={name: scan_plot(sensor_run, name) for name, one in sensor_run.sensors.items() if one.kind == "lidar"},
        cameras=camera_rows(sensor_run),
        sensor_run=sensor_run.name,
        state_sheets=state_sheets,
        images={(run, number): thumbnail(data[run].image(number)) for run, number in sorted(images)},
        brightness=brightness_plot(facts.images) if facts.images else b"",
        spread=spread_plot(spread_runs) if spread_runs else b"",
        spread_runs=len(spread_runs),
    )
