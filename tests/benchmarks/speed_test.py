# SPDX-License-Identifier: Apache-2.0
"""What speed.py makes of figures; what it measures is no test's business."""
import os
import sys
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
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


class Process(unittest.TestCase):
    def test_that_fails_is_told_with_what_it_said(self):
        with self.assertRaisesRegex(speed.Broken, "(?s)exit code 3.*no such thing"):
            speed.process(sys.executable, "-c", "print('no such thing'); raise SystemExit(3)")


if __name__ == "__main__":
    unittest.main()
