# SPDX-License-Identifier: Apache-2.0
"""What speed.py makes of figures; what it measures is no test's business."""
import os
import re
import sys
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import flame  # noqa: E402
import growth  # noqa: E402
import speed  # noqa: E402


def figure(values, better="less", unit="ms"):
    return speed.Figure("it", unit, better, values)


def row(values, better="less", other=None):
    return speed.Row("row", figure(values, better), other)


class Slower(unittest.TestCase):
    def found(self, now, then, better="less"):
        return speed.slower([row(now, better)], {"row": {"values": then}})

    def test_is_what_lies_beyond_both_spreads(self):
        self.assertEqual(self.found([5.1, 6.0], [4.0, 5.0]), ["row: 5.55 (5.1 … 6) ms, was 4.5 (4 … 5) ms"])
        self.assertEqual(self.found([4.9, 6.0], [4.0, 5.0]), [])
        self.assertEqual(self.found([1.0], [4.0, 5.0]), [])

    def test_of_rates_is_what_became_less(self):
        self.assertEqual(len(self.found([1.0, 2.0], [2.1, 3.0], "more")), 1)
        self.assertEqual(self.found([1.0, 2.2], [2.1, 3.0], "more"), [])
        self.assertEqual(self.found([9.0], [2.1, 3.0], "more"), [])

    def test_is_no_row_that_is_new(self):
        self.assertEqual(speed.slower([row([1.0])], {}), [])


class Ratio(unittest.TestCase):
    def test_says_how_many_times_better_the_bench_is(self):
        self.assertEqual(speed.ratio(row([1.0, 2.0, 9.0], "less", figure([4.0, 20.0, 10.0]))), 5.0)
        self.assertEqual(speed.ratio(row([6.0], "more", figure([2.0], "more"))), 3.0)


class Table(unittest.TestCase):
    def test_has_median_least_and_most(self):
        page = speed.table_of([row([3.0, 1.0, 2.0], "less", figure([4.0])), row([0.125])], 3)
        self.assertIn("| row | it: 2 (1 … 3) ms | it: 4 ms | 2 |", page)
        self.assertIn("| row | it: 0.125 ms |  |  |", page)
        self.assertIn("3 repeats", page)


    def test_says_what_a_row_was_before(self):
        page = speed.table_of([row([3.0]), row([1.0])._replace(name="new")], 1, {"row": {"values": [6.0]}})
        self.assertIn("| row | it: 3 ms | 6 ms |  |  |", page)
        self.assertIn("| new | it: 1 ms |  |  |  |", page)


class Page(unittest.TestCase):
    def test_holds_table_plots_and_what_was_before(self):
        plot = growth.Plot("units", "How it grows", "units", [growth.Curve("a", "s", (1, 10), [1.0, 10.0])])
        page = speed.page_of([row([3.0])], 1, {"row": {"values": [6.0]}}, "0123abcd", [plot])
        self.assertIn("| row | it: 3 ms | 6 ms |", page)
        self.assertIn("commit 0123abcd", page)
        self.assertIn("![How it grows](speed-units.svg)", page)
        self.assertNotIn("Before", speed.page_of([row([3.0])], 1, None, "", [plot]))


class Growth(unittest.TestCase):
    def test_is_told_by_the_larger_sizes(self):
        flat_then_square = growth.Curve("it", "s", (1, 10, 100, 1000), [100.0, 100.0, 100.0, 10000.0])
        self.assertAlmostEqual(growth.slope(flat_then_square), 2.0)
        self.assertAlmostEqual(growth.slope(growth.Curve("it", "s", (1, 10, 100), [2.0, 20.0, 200.0])), 1.0)

    def test_lines_are_as_many_as_asked_for_and_lie_apart(self):
        drawing = growth.square_of_lines(10)
        starts = re.findall(r"M([\d.]+),([\d.]+) v", drawing)
        self.assertEqual(len(set(starts)), 10)
        self.assertIn('width="12.0mm"', drawing)

    def test_plot_holds_all_points_and_both_slopes(self):
        curves = [growth.Curve("a", "s", (1, 10), [1.0, 10.0]), growth.Curve("b", "MiB", (1, 10), [5.0, 5.0])]
        svg = growth.svg_of(growth.Plot("x", "title", "sizes", curves))
        self.assertEqual(svg.count("<circle"), 4)
        self.assertIn("size^1.00", svg)
        self.assertIn("size^0.00", svg)


SAMPLES = """kerfbench
\t           1111 kerfbench::vision::(anonymous namespace)::fit<double, 3>
\t           2222 kerfbench::vision::trackSpot
\t           3333 std::__invoke_impl<void>
\tffffffffffffffff [unknown]

kerfbench
\tffffffff815fbe3f do_wp_page
\tffffffff816051c0 handle_mm_fault
\t           2222 kerfbench::vision::trackSpot

kerfbench-avr
\t           4444 avr_run_one
"""


class Flame(unittest.TestCase):
    def test_reads_stacks_from_the_program_down(self):
        self.assertEqual(flame.stacks_of(SAMPLES), [["kerfbench", "vision::trackSpot", "vision::fit"],
                                                    ["kerfbench", "vision::trackSpot", "the kernel"],
                                                    ["kerfbench-avr", "avr_run_one"]])

    def test_boxes_are_as_wide_as_their_share(self):
        boxes = {name: (round(x, 3), depth, round(share, 3))
                 for x, depth, share, name in flame.boxes_of(flame.tree_of(flame.stacks_of(SAMPLES)), 3)}
        self.assertEqual(boxes["kerfbench"], (0.0, 0, 0.667))
        self.assertEqual(boxes["vision::trackSpot"], (0.0, 1, 0.667))
        self.assertEqual(boxes["avr_run_one"], (0.667, 1, 0.333))

    def test_names_can_do_nothing_in_the_picture(self):
        self.assertNotIn("<b>", flame.svg_of([["a<b>c"]], "<b>"))


class Process(unittest.TestCase):
    def test_that_fails_is_told_with_what_it_said(self):
        with self.assertRaisesRegex(speed.Broken, "(?s)exit code 3.*no such thing"):
            speed.process(sys.executable, "-c", "print('no such thing'); raise SystemExit(3)")


if __name__ == "__main__":
    unittest.main()
