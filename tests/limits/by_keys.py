# SPDX-License-Identifier: Apache-2.0
"""Faults in what a controller is told of its machine, or the planner of the job."""
import datetime
import math

from drawing import marks
from job import EDGES, RESTING, SHORT_LINES, STOP_AND_GO, STRIP, Job

REACH_MM = 25.0  # The outline's sides lie that far from the middle, along x.
TRACKING_MS = 0.18568


def told(what, **others):
    return Job(others.pop("marks", marks()), machine=f"controller: {{{what}}}\n", **others)


def sensor_shifted(size_mm):
    """The controller is told another place of the print mark's sensor."""
    return told(f"print_mark_sensor_x_mm: {-150.0 + size_mm:.6f}")


def step_wrong(size_mm):
    """The controller takes a mirror's step for smaller than it is: all comes out too large."""
    return told(f"mirror_step_urad: {12.5 / (1.0 + size_mm / REACH_MM):.9f}", belt=RESTING)


def tracking_wrong(ms):
    """The controller takes the axes for later than they are, and opens the gate so much too late."""
    # Before the belt it steps ahead as well: 15 um for 0.5 ms, within what the path allows.
    return told(f"tracking_delay_ms: {TRACKING_MS + ms:.6f}")


def encoder_count_wrong(size_mm):
    """The gantry follows a strip that it takes for faster: so much over one cut."""
    cut_s = 800.0 / 230.0 + 230.0 / 2500.0
    count_mm = 0.01 * (1.0 + size_mm / (200.0 * cut_s))
    return told(f"encoder_count_mm: {count_mm:.12f}", marks=None, base=STRIP, keys="checks: {path_mm: 0.5}\n")


def table(of):
    """A correction table: what is added to the aim at each node."""
    rows = [f"{x},{y},{of(x, y)[0]:.9f},{of(x, y)[1]:.9f}" for y in range(-90, 91, 15) for x in range(-80, 81, 20)]
    return {"table.csv": "x_mm,y_mm,dx_mm,dy_mm\n" + "\n".join(rows) + "\n"}


def node_wrong(size_mm):
    """A mark that was measured wrong bends the table about its node, where the outline's upper side has its middle.

    The planner refuses a table of which a single node is wrong: it bends more than cubics follow.
    """
    return told("correction: table.csv", belt=RESTING,
                files=table(lambda x, y: (0.0, size_mm * math.exp(-0.5 * math.dist((x, y), (0, 15)) ** 2 / 30.0 ** 2))))


def table_sign_turned(size_mm):
    """A mirror turns too far, and the table that should mend it makes it twice as bad."""
    share = 0.5 * size_mm / REACH_MM
    job = told("correction: table.csv", belt=RESTING, files=table(lambda x, y: (share * x, 0.0)))
    job.machine += f"optics: {{mirror_x: {{scale: {1.0 + share:.9f}}}}}\n"
    return job


def meter_wrong(share):
    """The controller takes a quantum of the power meter for less than it is, and makes too much energy."""
    job = told(f"power_quantum_mj: {0.25 / (1.0 + share):.9f}", marks=None, base=SHORT_LINES,
               keys="checks: {line_energy_share: 0.05, even_depth_share: 0}\n")
    job.machine += "power_monitor: {quantum_mj: 0.25}\n"
    return job


def feed_step_wrong(size_mm):
    """The strip is fed by too little for each piece."""
    return told(f"feed_step_mm: {0.0125 * (1.0 + size_mm / 1200.0):.12f}", marks=None, base=STOP_AND_GO,
                keys="print: {units: 2}\n")


def kerf_radius(size_mm):
    """The kerf is compensated by too much."""
    return Job(keys=f"planner: {{kerf_radius_mm: {0.0508 + size_mm:.6f}}}\n", base=EDGES)


def calibration_old(days):
    """The day of the run is so long after that of the cameras' calibration."""
    day = datetime.date(2026, 11, 20) + datetime.timedelta(days=round(days))
    return Job(marks(), f"date: {day}\n")
