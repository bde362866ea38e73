# SPDX-License-Identifier: Apache-2.0
"""Does places.py find what its rule says, and nothing else?"""
import os
import sys
import tempfile
import unittest

import places
import sampled

TYPES = """
#include "types.h"  // < 1
namespace Eigen {
struct Vector {
  double operator()(int i) const;
  Vector head(int n) const;
  Vector operator-(const Vector& o) const;
  Vector operator-() const;
};
}  // namespace Eigen
namespace std {
template <typename T, int N> struct array { T& operator[](unsigned long i); };
template <typename C> struct basic_string {
  friend basic_string operator+(const basic_string& a, const basic_string& b) { return a; }
};
struct error { error(const char*, int); };
}  // namespace std
struct Place { double x; bool operator<(const Place& o) const; };
template <int N> int sized() { return N; }
using String = std::basic_string<char>;
struct Cell { std::array<std::array<double, 2>, 3> values; };
"""


def found(body, types=TYPES):
    """(text, replacements) of each place in a body of code, behind the types."""
    with tempfile.TemporaryDirectory() as folder:
        with open(os.path.join(folder, "types.h"), "w", encoding="utf-8"):
            pass
        text = types + body
        all_of_it = places.find(os.path.join(folder, "trap.cpp"), "trap.cpp", ["-std=c++20"], text)
    behind = len(types.encode())
    return [(p.text, p.puts) for p in all_of_it if p.offset >= behind]


class Rule(unittest.TestCase):
    def test_each_comparison_moves_at_its_limit_and_looks_the_other_way(self):
        for text, puts in places.COMPARISONS.items():
            self.assertEqual(found(f"bool f(double a, double b) {{ return a {text} b; }}"), [(text, puts)])

    def test_signs_between_values_turn_and_a_minus_before_one_is_left_out(self):
        self.assertEqual(found("double f(double a, double b) { return a - -b + (-a) * +b; }"),
                         [("-", ("+",)), ("-", ("",)), ("+", ("-",)), ("-", ("",))])
        self.assertEqual(found("void f(double& a, double b) { a += b; a -= b; }"), [("+=", ("-=",)), ("-=", ("+=",))])
        self.assertEqual(found("double f(bool b, double a) { return b ? -a : -a; }"), [("-", ("",))] * 2)

    def test_signs_of_classes_are_signs_and_text_has_none(self):
        self.assertEqual(found("Eigen::Vector f(Eigen::Vector a, Eigen::Vector b) { return -a - b; }"),
                         [("-", ("",)), ("-", ("+",))])
        self.assertEqual(found("String f(String a, String b) { return a + b; }"), [])

    def test_constants_grow(self):
        for text, put in {"1e-9": "1.25e-9", "0.0": "1.0", "2.5F": "3.125F", "1'000": "1001", "0": "1", "1'0.5e3": "13125.0",
                          ".5": "0.625", "0x1F": "32", "7U": "8U", "1e300": "1.25e+300"}.items():
            self.assertEqual(found(f"auto f() {{ return {text}; }}"), [(text, (put,))])
        self.assertEqual(found("bool f() { return true; }"), [("true", ("false",))])

    def test_a_grown_constant_is_one_number_more(self):
        for text in ["1e-9", "0.33", "6.0", "1'000.5", "3.", "1e6", "123456789.0", "1e-5"]:
            self.assertAlmostEqual(float(places.grown(text)) / float(text.replace("'", "")), 1.25, places=14)
        self.assertIsNone(places.grown("010"))
        self.assertIsNone(places.grown("10ms"))

    def test_connectives_swap(self):
        self.assertEqual(found("bool f(bool a, bool b, bool c) { return a && b || c; }"), [("&&", ("||",)), ("||", ("&&",))])


class Traps(unittest.TestCase):
    def test_brackets_of_templates_compare_nothing(self):
        self.assertEqual(found("std::array<std::array<double, 2>, 3> f() { return {}; }"), [])
        self.assertEqual(found("template <int N> double g(const std::array<double, N>& a);"), [])
        self.assertEqual(found("long f(double a) { return static_cast<long>(a) < sized<4>(); }"),
                         [("<", ("<=", ">"))])

    def test_a_comparison_behind_a_template_is_found(self):
        self.assertEqual(found("bool f(int a) { return sized<(3 > 2)>() > a; }"), [(">", (">=", "<"))])

    def test_a_comparison_of_a_type_that_is_not_known_yet_is_found(self):
        self.assertEqual(found("template <typename T> bool f(T a, T b) { return a < b; }"), [("<", ("<=", ">"))])
        self.assertEqual(found("auto f() { return [](auto a, auto b) { return a - b; }; }"), [("-", ("+",))])

    def test_operators_that_are_named_or_defined_compare_nothing(self):
        self.assertEqual(found("bool Place::operator<(const Place& o) const { return x < o.x; }"), [("<", ("<=", ">"))])
        self.assertEqual(found("bool f(Place a, Place b) { return a.operator<(b); }"), [])
        self.assertEqual(found("bool f(Place a, Place b) { return a < b; }"), [("<", ("<=", ">"))])

    def test_arrows_shifts_and_references_are_no_signs(self):
        self.assertEqual(found("double f(const Place* p) { return p->x; }"), [])
        self.assertEqual(found("int f(int a, int b) { return a << b >> a; }"), [])
        self.assertEqual(found("void f(Place&& p); auto g(int a) { ++a; --a; return a++; }"), [])
        self.assertEqual(found("auto f(int a, int b) -> int { return a & b | a; }"), [])

    def test_comments_text_and_directives_hold_no_code(self):
        self.assertEqual(found("// a < 1 && b\n/* 2.0 - 1 */ const char* f() { return \"a < 1 + 2\"; }"), [])
        self.assertEqual(found("const char* f() { return R\"(1 < 2)\"; } char g() { return '1'; }"), [])
        self.assertEqual(found("#include \"types.h\"\n#if 1 < 2\n#endif\n"), [])

    def test_refusals_and_assertions_of_the_compiler_are_left_alone(self):
        self.assertEqual(found("static_assert(1 < 2); void f(int a) { throw std::error(\"no\", a + 1); }"), [])

    def test_an_index_says_which_and_not_how_much(self):
        self.assertEqual(found("double f(Cell& c, double* p) { return c.values[1][0] * p[2]; }"), [])
        self.assertEqual(found("double f(const Eigen::Vector& v) { return v(1) * v.head(2)(0); }"), [])
        self.assertEqual(found("double f(double* p, int i) { return p[i + 1]; }"), [("+", ("-",)), ("1", ("2",))])
        self.assertEqual(found("int f(int); int g() { return f(2); }"), [("2", ("3",))])

    def test_places_are_counted_in_bytes_and_named_after_what_they_are_in(self):
        text = "// Grad: °\nconstexpr double kTurn = 2.0;\nstruct S { int f() { return 1 + 1; } };\n"
        all_of_it = places.find("/nowhere/trap.cpp", "a/trap.cpp", ["-std=c++20"], text)
        self.assertEqual([p.name_of for p in all_of_it], ["trap.kTurn.2.0-1", "trap.f.1-1", "trap.f.plus-1", "trap.f.1-2"])
        self.assertEqual([text.encode()[p.offset:p.offset + len(p.text)].decode() for p in all_of_it],
                         [p.text for p in all_of_it])

    def test_a_source_that_clang_does_not_understand_is_refused(self):
        with self.assertRaises(places.Unparsed):
            found("int f( {")


class Draw(unittest.TestCase):
    FOUND = [places.Place("f.cpp", i, "<", ("<=", ">"), i, "f", f"f.f.less-{i}") for i in range(1000)]

    def test_the_same_seed_draws_the_same_and_another_does_not(self):
        self.assertEqual(sampled.sample(self.FOUND, 50, 16), sampled.sample(self.FOUND, 50, 16))
        self.assertNotEqual(sampled.sample(self.FOUND, 50, 16), sampled.sample(self.FOUND, 50, 17))

    def test_each_stretch_gives_one_place(self):
        drawn = sorted(m.offset for m in sampled.sample(self.FOUND, 40, 16))
        self.assertEqual([offset // 25 for offset in drawn], list(range(40)))
        self.assertEqual(sorted(m.offset for m in sampled.sample(self.FOUND, 1000, 3)), list(range(1000)))

    def test_all_faults_of_a_place_are_drawn(self):
        self.assertEqual({m.put for m in sampled.sample(self.FOUND, 40, 16)}, {"<=", ">"})


class Order(unittest.TestCase):
    def test_cheap_tests_run_first_and_each_once(self):
        timed = [(9000, "a", "slow"), (1, "a", "quick"), (2, "b", "quick"), (9000, "b", "slow"), (400, "a", "mean"),
                 (20000, "a", "dear")]
        groups = sampled.groups_of(timed)
        self.assertEqual(groups, [("a", ["quick"], 1), ("b", ["quick"], 2), ("a", ["mean", "slow"], 9400),
                                  ("b", ["slow"], 9000), ("a", ["dear"], 20000)])


class Score(unittest.TestCase):
    PAGE = ("# Mutants\n\n## The same by proof\n\n### a.same\nWhy.\n\n### a.was-killed\nWhy.\n\n"
            "## Others\n\n### b.lives\nWhy.\n")

    def setUp(self):
        file = tempfile.NamedTemporaryFile("w", suffix=".md", delete=False, encoding="utf-8")
        with file:
            file.write(self.PAGE)
        self.addCleanup(os.remove, file.name)
        self.addCleanup(setattr, sampled, "REASONS", sampled.REASONS)
        sampled.REASONS = file.name

    def test_the_page_is_read_by_its_parts(self):
        self.assertEqual(sampled.reasons(), {"a.same", "a.was-killed", "b.lives"})
        self.assertEqual(sampled.reasons(sampled.PROVEN), {"a.same", "a.was-killed"})

    def test_only_survivors_with_a_proof_are_left_out(self):
        cells = {"a.same": "**survived**", "a.was-killed": "t: T", "b.lives": "**survived**", "c": "t: T"}
        text, share = sampled.score(cells)
        self.assertAlmostEqual(share, 2.0 / 3.0)
        self.assertIn("1 are the same", text)

    def test_a_survivor_that_nobody_proves_counts(self):
        self.assertAlmostEqual(sampled.score({"b.lives": "**survived**", "c": "t: T"})[1], 0.5)


if __name__ == "__main__":
    sys.exit(unittest.main())
