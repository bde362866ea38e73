# SPDX-License-Identifier: Apache-2.0
"""Ways to tamper with the recorded pins. Each changes a Recording in place, and raises NothingToEdit where there is nothing.

A PASS is allowed only where `consistent` says why a good machine gives the same evidence (`at_rest`: the one whose sheet rests), or
`unread` why nobody reads what was changed. They are sentences of the page.
"""
import bisect

from recording import Edge

PULSES = ("galvo_x_pul", "galvo_y_pul")
ENCODER = ("encoder_a", "encoder_b")
EDITS = []


class NothingToEdit(Exception):
    pass


class PinEdit:
    def __init__(self, name, kind, what, apply, consistent, at_rest, unread, quick):
        self.name, self.kind, self.what, self.apply = name, kind, what, apply
        self.consistent, self.at_rest, self.unread, self.quick = consistent, at_rest, unread, quick

    def reason(self, case):
        """Why a PASS of this case is right; empty: it is not."""
        return self.consistent or self.unread or (self.at_rest if case == "rest" else "")


def edit(kind, what, consistent="", at_rest="", unread="", quick=False):
    def note(apply):
        EDITS.append(PinEdit(apply.__name__.replace("_", "-"), kind, what, apply, consistent, at_rest, unread, quick))
        return apply
    return note


def some(edges):
    if not edges:
        raise NothingToEdit
    return edges


def sort(recording):
    recording.edges.sort(key=lambda edge: edge.stamp)


def middle(recording, *wires):
    """The edge of these wires in the middle of the laser's work."""
    begin, end = lit(recording)
    among = some([edge for edge in recording.of(*wires) if begin <= edge.stamp <= end])
    return among[len(among) // 2]


def lit(recording):
    """First and last stamp of the gate."""
    some(recording.of("laser_gate"))
    return recording.span("laser_gate")


def without(recording, edges):
    gone = {id(edge) for edge in some(edges)}
    recording.edges = [edge for edge in recording.edges if id(edge) not in gone]


def pulses(recording, *wires):
    """Pulses of each wire: pairs of edges, up and down."""
    for wire in wires:
        edges = recording.of(wire)
        yield from zip(edges[::2], edges[1::2])


def cut_out(recording, begin, end):
    """Takes a stretch of time away; what comes later, words and the end too, moves up."""
    step = end - begin
    recording.edges = [edge for edge in recording.edges if not begin < edge.stamp <= end]
    recording.words = [word for word in recording.words if not begin < word[0] * recording.units_per_tick <= end]
    for edge in recording.edges:
        edge.stamp -= step if edge.stamp > end else 0
    ticks = step // recording.units_per_tick
    recording.words = [(tick - ticks if tick * recording.units_per_tick > end else tick, hex) for tick, hex in recording.words]
    recording.last -= step
    recording.set_comment("end", recording.last // recording.units_per_tick)
    recording.recount()
    recording.mend()


def end_at(recording, stamp):
    recording.edges = [edge for edge in recording.edges if edge.stamp <= stamp]
    recording.words = [word for word in recording.words if word[0] * recording.units_per_tick <= stamp]
    recording.last = stamp
    recording.set_comment("end", stamp // recording.units_per_tick)
    recording.recount()


# --- Time


@edit("time", "50 ms cut out of the middle of the job, the rest moved up")
def stretch_out_middle(r):
    at = middle(r, *PULSES).stamp
    cut_out(r, at, at + r.units(0.05))


@edit("time", "50 ms in the middle of the job without an edge of any wire")
def stretch_blank(r):
    at = middle(r, *PULSES).stamp
    r.edges = [edge for edge in r.edges if not at < edge.stamp <= at + r.units(0.05)]
    r.mend()


@edit("time", "the first 0.15 s cut out",
      at_rest="No drive had moved yet, and the sheet waited.")
def stretch_out_begin(r):
    cut_out(r, r.units(0.001), r.units(0.151))


@edit("time", "all before the last third of the laser's work cut out")
def stretch_out_first_marks(r):
    begin, end = lit(r)
    cut_out(r, r.units(0.001), begin + r.units((end - begin) / 3 * 2 / r.units_per_s()))


@edit("time", "the recording ends in the middle of the job")
def ends_early(r):
    end_at(r, middle(r, *PULSES).stamp)


@edit("time", "the recording ends 1 ms after the laser's last work",
      consistent="Without words nothing tells that more was to come: `finish` is not judged, and the line of the verdict says so.")
def ends_after_light(r):
    end_at(r, lit(r)[1] + r.units(0.001))


@edit("time", "the last 50 ms are missing, after which nothing moves",
      consistent="Nothing happened in them.")
def ends_50_ms_early(r):
    end_at(r, r.last - r.units(0.05))


@edit("time", "20 ms of the cut are there twice, one after the other")
def stretch_twice(r):
    at = middle(r, *PULSES).stamp
    step = r.units(0.02)
    again = [Edge(e.stamp + step, e.wire, e.level) for e in r.edges if at < e.stamp <= at + step]
    for edge in r.edges:
        edge.stamp += step if edge.stamp > at + step else 0
    ticks = step // r.units_per_tick
    r.words = [(tick + ticks if tick * r.units_per_tick > at else tick, hex) for tick, hex in r.words]
    r.edges += again
    r.last += step
    r.set_comment("end", r.last // r.units_per_tick)
    sort(r)
    r.mend()


@edit("time", "two stamps exchanged, so that time goes back", quick=True)
def stamps_swapped(r):
    at = r.edges.index(middle(r, *PULSES))
    behind = next(i for i in range(at, len(r.edges)) if r.edges[i].stamp > r.edges[at].stamp)
    r.edges[at].stamp, r.edges[behind].stamp = r.edges[behind].stamp, r.edges[at].stamp


@edit("time", "the edges at two stamps 1 ms apart exchanged, stamps in order",
      consistent="A step of 12.5 um is a millisecond off, a quarter of the limit of the path.")
def edges_swapped(r):
    first = middle(r, *PULSES)
    later = next(e for e in r.edges if e.stamp >= first.stamp + r.units(0.001) and e.wire != first.wire)
    first.stamp, later.stamp = later.stamp, first.stamp
    sort(r)
    r.mend()


@edit("time", "the time scale ten times as coarse")
def timescale_coarser(r):
    scale(r, {"100 ps": "1 ns", "10 us": "100 us", "1 us": "10 us"})


@edit("time", "the time scale ten times as fine")
def timescale_finer(r):
    scale(r, {"100 ps": "10 ps", "10 us": "1 us", "1 us": "100 ns"})


def scale(recording, others):
    at = next(i for i, line in enumerate(recording.header) if line.startswith("$timescale"))
    recording.header[at] = f"$timescale {others[' '.join(recording.header[at].split()[1:3])]} $end"


@edit("time", "the recording's tick says twice the clock")
def tick_halved(r):
    num, den = next(line for line in r.header if "kerfbench tick" in line).split()[3].split("/")
    r.set_comment("tick", f"{num}/{2 * int(den)}")


@edit("time", "all stamps 0.1 % later",
      at_rest="On a sheet at rest all is the same, a thousandth slower.")
def clock_slow(r):
    stretch(r, 1001, 1000)


@edit("time", "all stamps 0.1 % earlier",
      at_rest="On a sheet at rest all is the same, a thousandth faster.")
def clock_fast(r):
    stretch(r, 999, 1000)


def stretch(recording, num, den):
    unit = recording.units_per_tick
    for edge in recording.edges:
        edge.stamp = edge.stamp * num // den // unit * unit
    recording.words = [(tick * num // den, hex) for tick, hex in recording.words]
    recording.last = recording.last * num // den // unit * unit
    recording.set_comment("end", recording.last // unit)


@edit("time", "the header says that the run went on for a second")
def end_later(r):
    r.set_comment("end", r.last // r.units_per_tick + r.units(1.0) // r.units_per_tick)


@edit("time", "the header says that stamps may be off by 1 us",
      consistent="Less certain evidence, judged with a wider guard band.")
def stamps_less_certain(r):
    r.set_comment("stamp_err", r.units(1e-6) // r.units_per_tick)


@edit("time", "an edge behind the sum, in the sum's own line")
def edge_behind_sum(r):
    r.behind = f" 1{r.ids['laser_gate']}"


# --- Pulses of the drives


def drop_pulses(recording, every):
    gone = []
    for number, pair in enumerate(pulses(recording, *PULSES)):
        gone += pair if number % every == every - 1 else ()
    without(recording, gone)


@edit("pulses", "every 100th pulse of the mirrors dropped")
def pulse_100(r):
    drop_pulses(r, 100)


@edit("pulses", "every 1000th pulse of the mirrors dropped")
def pulse_1000(r):
    drop_pulses(r, 1000)


@edit("pulses", "every 5000th pulse of the mirrors dropped",
      consistent="Six or fewer steps of 12.5 um, and where they are missing both ways they cancel.")
def pulse_5000(r):
    drop_pulses(r, 5000)


@edit("pulses", "every 1000th edge of any wire dropped")
def edge_1000(r):
    without(r, r.edges[999::1000])


@edit("pulses", "every 5000th edge of any wire dropped")
def edge_5000(r):
    without(r, r.edges[4999::5000])


@edit("pulses", "one rising edge of a mirror dropped, its falling one kept")
def edge_one(r):
    at = r.edges.index(middle(r, "galvo_x_pul"))
    without(r, [next(e for e in r.edges[at:] if e.wire == "galvo_x_pul" and e.level == "1")])


@edit("pulses", "one pulse of a mirror dropped",
      consistent="One step is 12.5 um on the sheet, a quarter of the limit: without the controller's words nobody knows of it.")
def pulse_one(r):
    without(r, pulse_after(r, "galvo_x_pul", lit(r)[0]))


def pulse_after(recording, wire, stamp):
    pair = next((pair for pair in pulses(recording, wire) if pair[0].stamp >= stamp), None)
    return some(pair)


def pulse_with_room(recording, wire, step_s):
    """A pulse while the laser works that meets no other of its wire, nor a change of DIR, when it comes so much later."""
    stamps = sorted(each.stamp for each in recording.of(wire, wire.replace("pul", "dir")))
    clear, step, begin = recording.units(6e-6), recording.units(step_s), middle(recording, wire).stamp
    for up, down in pulses(recording, wire):
        if up.stamp < begin:
            continue
        near = stamps[bisect.bisect_left(stamps, up.stamp + step - clear):bisect.bisect_right(stamps, down.stamp + step + clear)]
        if all(stamp in (up.stamp, down.stamp) for stamp in near):
            return up, down
    raise NothingToEdit


@edit("pulses", "every edge is there twice, at the same stamp", quick=True)
def edges_doubled(r):
    r.edges = [copy for edge in r.edges for copy in (edge, Edge(edge.stamp, edge.wire, edge.level))]


@edit("pulses", "one edge is there twice, a microsecond apart")
def edge_doubled(r):
    at = middle(r, "galvo_x_pul")
    r.edges.append(Edge(at.stamp + r.units(1e-6), at.wire, at.level))
    sort(r)


@edit("pulses", "every pulse of the mirrors is there twice")
def pulses_doubled(r):
    more = []
    for up, down in pulses(r, *PULSES):
        step = 2 * (down.stamp - up.stamp)
        more += [Edge(up.stamp + step, up.wire, "1"), Edge(down.stamp + step, up.wire, "0")]
    r.edges += some(more)
    sort(r)


@edit("pulses", "one pulse of a mirror is there twice",
      consistent="One step is 12.5 um on the sheet, a quarter of the limit: without the controller's words nobody knows of it.")
def pulse_doubled(r):
    step = r.units(15e-6)
    up, down = pulse_with_room(r, "galvo_x_pul", 15e-6)
    r.edges += [Edge(up.stamp + step, up.wire, "1"), Edge(down.stamp + step, up.wire, "0")]
    sort(r)


def move(recording, wire, seconds):
    up, down = pulse_with_room(recording, wire, seconds)
    up.stamp += recording.units(seconds)
    down.stamp += recording.units(seconds)
    sort(recording)


@edit("pulses", "one pulse of a mirror 1 us later", quick=True,
      consistent="A mirror that trails by 0.2 ms does not notice a microsecond, and the drive's times are kept.")
def pulse_moved_1_us(r):
    move(r, "galvo_x_pul", 1e-6)


@edit("pulses", "one pulse of a mirror 10 us later",
      consistent="A tenth of a period of the mirror's loop at 12.5 um: far below the limit of the path.")
def pulse_moved_10_us(r):
    move(r, "galvo_x_pul", 10e-6)


@edit("pulses", "one pulse of a mirror 1 ms later",
      consistent="One step of 12.5 um is missing for a millisecond, a quarter of the limit of the path.")
def pulse_moved_1_ms(r):
    move(r, "galvo_x_pul", 1e-3)


@edit("pulses", "DIR of a mirror inverted")
def dir_inverted(r):
    for each in some(r.of("galvo_x_dir")):
        each.level = "10"[int(each.level)]
    r.edges.insert(0, Edge(0, "galvo_x_dir", "1"))


@edit("pulses", "a change of DIR of a mirror and the one behind it taken away")
def dir_edges_out(r):
    at = r.of("galvo_x_dir").index(middle(r, "galvo_x_dir"))
    without(r, r.of("galvo_x_dir")[at:at + 2])


@edit("pulses", "DIR changes at the stamp of its pulse")
def dir_at_pulse(r):
    change = some(r.of("galvo_x_dir"))[-1]
    change.stamp = pulse_after(r, "galvo_x_pul", change.stamp + 1)[0].stamp
    sort(r)


@edit("pulses", "the two mirrors' pulses exchanged")
def axes_swapped(r):
    other = {"galvo_x_pul": "galvo_y_pul", "galvo_y_pul": "galvo_x_pul"}
    for each in r.edges:
        each.wire = other.get(each.wire, each.wire)


@edit("pulses", "the wire of a mirror's pulses taken out of the file")
def wire_out(r):
    r.edges = [each for each in r.edges if each.wire != "galvo_y_pul"]
    r.header = [line for line in r.header if " galvo_y_pul " not in line]
    r.rest = r.rest.replace(f"0{r.ids['galvo_y_pul']}\n", "")


@edit("pulses", "a level of a mirror's wire unknown (x)")
def level_unknown(r):
    middle(r, "galvo_x_pul").level = "x"


# --- Laser


@edit("laser", "the gate held on from the first to the last light",
      consistent="The pulses of its power pause between the marks, so no light falls; `gate_lag` is not judged, and the line says so.")
def gate_held(r):
    edges = some(r.of("laser_gate"))
    without(r, edges[1:-1])


@edit("laser", "gate and power held on from the first to the last light", quick=True)
def light_held(r):
    powers, edges = list(pulses(r, "laser_pwm")), some(r.of("laser_gate"))
    without(r, edges[1:-1])
    for before, after in zip(powers, powers[1:]):
        period = r.units(60e-6)
        for at in range(before[0].stamp + period, after[0].stamp - period, period):
            r.edges += [Edge(at, "laser_pwm", "1"), Edge(at + period // 2, "laser_pwm", "0")]
    sort(r)


@edit("laser", "the gate never goes off again")
def gate_never_off(r):
    without(r, some(r.of("laser_gate"))[-1:])


def light(recording, begin, seconds):
    """Light for so long from a stamp on, at the power with which the job begins."""
    first = lit(recording)[0]
    end = begin + recording.units(seconds)
    more = [Edge(begin, "laser_gate", "1"), Edge(end, "laser_gate", "0")]
    for up, down in pulses(recording, "laser_pwm"):
        if first <= up.stamp and begin + down.stamp - first < end:
            more += [Edge(begin + up.stamp - first, "laser_pwm", "1"), Edge(begin + down.stamp - first, "laser_pwm", "0")]
    recording.edges += more
    sort(recording)


@edit("laser", "the gate on for 50 ms while the beam waits for its first mark")
def gate_at_rest_before(r):
    light(r, lit(r)[0] - r.units(0.08), 0.05)


@edit("laser", "the gate on for 50 ms behind the last mark")
def gate_at_rest_after(r):
    light(r, lit(r)[1] + r.units(0.01), 0.05)


@edit("laser", "the gate off 20 ms before the end of the last mark")
def gate_off_early(r):
    r.of("laser_gate")[-1].stamp -= r.units(0.02)
    sort(r)


@edit("laser", "the gate on 2 ms before the first mark begins",
      consistent="The pulses of its power begin with the mark, so no light falls before.")
def gate_on_early(r):
    r.of("laser_gate")[0].stamp -= r.units(0.002)
    sort(r)


@edit("laser", "an edge of the gate 1 us later",
      consistent="A third of a micrometre of the mark at 300 mm/s.")
def gate_moved_1_us(r):
    r.of("laser_gate")[-1].stamp += r.units(1e-6)
    sort(r)


@edit("laser", "the gate off for 10 ms in the middle of a mark")
def gate_interrupted(r):
    at = middle(r, *PULSES).stamp
    gates = list(pulses(r, "laser_gate"))
    if not any(on.stamp < at and at + r.units(0.01) < off.stamp for on, off in gates):
        on, off = max(gates, key=lambda pair: pair[1].stamp - pair[0].stamp)
        at = on.stamp + (off.stamp - on.stamp) // 3 // r.units_per_tick * r.units_per_tick
    r.edges += [Edge(at, "laser_gate", "0"), Edge(at + r.units(0.01), "laser_gate", "1")]
    sort(r)


@edit("laser", "all pulses of the laser's power taken away")
def pwm_out(r):
    without(r, r.of("laser_pwm"))


@edit("laser", "every second pulse of the laser's power taken away")
def pwm_every_2(r):
    without(r, [each for pair in list(pulses(r, "laser_pwm"))[1::2] for each in pair])


# --- Sensors


@edit("sensors", "all edges of the belt's encoder taken away")
def encoder_out(r):
    without(r, r.of(*ENCODER))


@edit("sensors", "every 1000th edge of the belt's encoder taken away")
def encoder_1000(r):
    without(r, r.of(*ENCODER)[999::1000])


@edit("sensors", "one edge of the belt's encoder taken away")
def encoder_one_edge(r):
    without(r, [middle(r, *ENCODER)])


@edit("sensors", "one edge of the belt's encoder 1 us later",
      consistent="The web travels 0.06 um meanwhile.")
def encoder_moved_1_us(r):
    middle(r, "encoder_a").stamp += r.units(1e-6)
    sort(r)


@edit("sensors", "the encoder's two wires exchanged: the web runs backwards")
def encoder_swapped(r):
    for each in some(r.of(*ENCODER)):
        each.wire = "encoder_b" if each.wire == "encoder_a" else "encoder_a"


@edit("sensors", "100 ms of the encoder taken away in the middle of the job")
def encoder_stretch_out(r):
    at = middle(r, *ENCODER).stamp
    without(r, [each for each in r.of(*ENCODER) if at < each.stamp <= at + r.units(0.1)])


@edit("sensors", "the encoder's edges 0.5 % closer together")
def encoder_scaled(r):
    for each in some(r.of(*ENCODER)):
        each.stamp = each.stamp * 995 // 1000 // r.units_per_tick * r.units_per_tick
    sort(r)


@edit("sensors", "all edges of the encoder before the first mark taken away")
def encoder_before_out(r):
    begin = lit(r)[0]
    without(r, [each for each in r.of(*ENCODER) if each.stamp < begin])


@edit("sensors", "an encoder that turns is written into the recording")
def encoder_forged(r):
    if r.of(*ENCODER):
        raise NothingToEdit
    steps = (("encoder_a", "1"), ("encoder_b", "1"), ("encoder_a", "0"), ("encoder_b", "0"))
    r.edges += [Edge(r.units(0.001 * (1 + i)), *steps[i % 4]) for i in range(500)]
    sort(r)


@edit("sensors", "the print mark's edges taken away", quick=True)
def print_mark_out(r):
    without(r, r.of("print_mark"))


@edit("sensors", "the print mark 20 ms later")
def print_mark_late(r):
    for each in some(r.of("print_mark")):
        each.stamp += r.units(0.02)
    sort(r)


@edit("sensors", "a second print mark")
def print_mark_twice(r):
    r.edges += [Edge(each.stamp + r.units(0.3), each.wire, each.level) for each in some(r.of("print_mark"))]
    sort(r)


@edit("sensors", "the guard opens in the middle of the cut, and stays open")
def guard_opens(r):
    r.edges.append(Edge(middle(r, *PULSES).stamp, "interlock", "0"))
    sort(r)


@edit("sensors", "the guard opens for 10 us in the middle of the cut")
def guard_flickers(r):
    at = middle(r, *PULSES).stamp
    r.edges += [Edge(at, "interlock", "0"), Edge(at + r.units(10e-6), "interlock", "1")]
    sort(r)


@edit("sensors", "the guard never closed")
def guard_never_closed(r):
    without(r, r.of("interlock"))


@edit("sensors", "a limit switch hit in the middle of the cut")
def limit_hit(r):
    r.edges.append(Edge(middle(r, *PULSES).stamp, "limit_x", "1"))
    sort(r)


# --- Words of the controller


def say(recording, words):
    if words == recording.words:
        raise NothingToEdit
    recording.words = words
    recording.recount()


@edit("words", "all words of the controller taken away",
      consistent="A recording of pins alone, as of any firmware that says nothing.")
def words_out(r):
    say(r, [])


@edit("words", "the last word taken away",
      consistent="It is the rest of a report like those before it, and a recording may end in the middle of one.")
def word_last_out(r):
    say(r, r.words[:-1])


@edit("words", "the last 40 words taken away", quick=True)
def words_last_40_out(r):
    say(r, r.words[:-40])


@edit("words", "a word in the middle taken away")
def word_middle_out(r):
    middle_word = len(r.words) // 2
    say(r, r.words[:middle_word] + r.words[middle_word + 1:])


@edit("words", "one digit of the last word changed")
def word_last_garbled(r):
    tick, digits = some(r.words)[-1]
    say(r, r.words[:-1] + [(tick, digits[:-1] + "%x" % (int(digits[-1], 16) ^ 1))])


@edit("words", "the last word said before the first mark")
def word_last_early(r):
    begin = lit(r)[0] // r.units_per_tick
    early = [word for word in some(r.words) if word[0] < begin]
    late = [word for word in r.words if word[0] >= begin]
    step = late[-1][0] - begin
    say(r, early + [(tick - step, digits) for tick, digits in late if tick - step > early[-1][0]])


@edit("words", "the header counts fewer words than there are")
def words_miscounted(r):
    r.set_comment("words", len(some(r.words)) - 1)


# --- What nobody reads


@edit("comments", "a foreign comment in the header",
      unread="A comment of another program, which the format allows anywhere: no evidence.")
def comment_added(r):
    r.header.insert(1, "$comment nothing of interest $end")


@edit("comments", "the name of the program that wrote it",
      unread="$version is for people: no evidence.")
def version_changed(r):
    r.header[0] = "$version somebody else $end"


@edit("comments", "a date in the header",
      unread="$date is for people: no evidence.")
def date_added(r):
    r.header.insert(1, "$date today $end")
