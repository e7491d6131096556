import numpy as np
import pytest

from nrs_design.robot.reporting.figures import draw_tracking
from nrs_design.robot.simulation.experiment import Experiment, TrackingRecord

ERROR = np.radians([0.5, 0.01, 0.0])


def record(controller, moved):
    experiment = Experiment(moved, (0.0, 0.0, 0.2), 0.05, 2.0, hold=1.0)
    time = np.linspace(0, experiment.duration, 300)
    wanted = experiment.motion(time)[0]
    return TrackingRecord(
        controller, experiment, time, wanted, wanted - ERROR, wanted, np.zeros((300, 3))
    )


@pytest.fixture(scope="module")
def figure():
    records = [record(name, moved) for name in ("one", "other") for moved in ("d", "phi")]
    return draw_tracking(records, [(0.1, 0.2, 0.3), None, None, None])


def test_a_column_for_each_motion(figure):
    assert [axes.get_title() for axes in figure.axes] == ["d moves", "φ moves", "", ""]
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert labels == ["one, simulated", "other, simulated", "wanted", "on the robot"]


def test_bars_are_the_errors(figure):
    bars = [bar.get_height() for bar in figure.axes[2].patches]
    # Below the axis an error is drawn at its foot.
    assert bars == pytest.approx([0.5, 0.01, 1e-3] * 2)
    (points,) = figure.axes[2].lines
    assert list(points.get_ydata()) == [0.1, 0.2, 0.3]
    assert not figure.axes[3].lines


def test_one_motion_without_measurements():
    figure = draw_tracking([record("one", "psi")], [None])
    assert len(figure.axes) == 2
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert labels == ["one, simulated", "wanted"]


def test_controllers_that_track_alike_are_told_apart(figure):
    _, first, second = sorted(figure.axes[0].lines, key=lambda line: -line.get_zorder())
    assert first.get_linestyle() != second.get_linestyle()
    box = figure.legends[0].get_window_extent()
    assert box.x0 >= 0
    assert box.x1 <= figure.bbox.width
