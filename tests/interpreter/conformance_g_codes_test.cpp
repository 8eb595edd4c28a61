// Conformance of the G codes: manual 3.4, one row per form that it describes. What it calls an
// error is in conformance_errors_test.cpp.
#include <array>
#include <catch2/catch.hpp>

#include "tests/interpreter/conformance.h"
#include "tests/interpreter/support.h"

using namespace cnc::interp::test;

namespace {

// Moves as moves_of() writes them. #5161 … are the parking positions, #5401 … tool lengths, #5501 …
// tool diameters.
constexpr auto kMoves = std::to_array<Row>({
    {"3.4.1 G0 moves to the destination", "G0 X1 Y2 Z3", "rapid 1 2 3"},
    {"3.4.1 G0 is optional while it is active", "G0 X1\nY2", "rapid 1 0 0; rapid 1 2 0"},
    {"3.4.1 omitted axes keep their value", "G0 X1 Y2\nZ3", "rapid 1 2 0; rapid 1 2 3"},
    {"3.4.2 G1 moves at feed rate", "F60 G1 X1 Y2 Z3", "feed 1 2 3"},
    {"3.4.2 G1 is optional while it is active", "F60 G1 X1\nY2", "feed 1 0 0; feed 1 2 0"},

    // Around (10, 0): from 180 degrees clockwise to 90.
    {"3.4.3.1 G2 with R, up to 180 degrees", "F60 G2 X10 Y10 R10", "arc 10 10 0 around 10 0 cw"},
    {"3.4.3.1 G2 with negative R, from 180 degrees", "F60 G2 X10 Y10 R-10",
     "arc 10 10 0 around 0 10 cw"},
    {"3.4.3.1 G3 with R", "F60 G3 X10 Y10 R10", "arc 10 10 0 around 0 10 ccw"},
    {"3.4.3.1 G3 with negative R", "F60 G3 X10 Y10 R-10", "arc 10 10 0 around 10 0 ccw"},
    {"3.4.3.1 one word of the plane is enough", "F60 G2 X20 R10", "arc 20 0 0 around 10 0 cw"},
    {"3.4.3.1 a helix", "F60 G2 X10 Y10 Z5 R10", "arc 10 10 5 around 10 0 cw"},
    // The manual's example: from (7, 7) around (7+3, 7+4) to (10, 16).
    {"3.4.3.2 G17 with I and J", "F60 G0 X7 Y7 Z9\nG17 G2 x10 y16 i3 j4 z9",
     "rapid 7 7 9; arc 10 16 9 around 10 11 cw"},
    {"3.4.3.2 I or J may be missing", "F60 G3 X10 Y10 J10", "arc 10 10 0 around 0 10 ccw"},
    // In G18 the first axis is Z, the second X.
    {"3.4.3.2 G18 with I and K", "F60 G18 G2 X10 Z10 I0 K10", "arc 10 0 10 around 10 0 cw"},
    {"3.4.3.1 G18 with R", "F60 G18 G2 X10 Z10 R10", "arc 10 0 10 around 10 0 cw"},
    {"3.4.3.2 G19 with J and K", "F60 G19 G2 Y10 Z10 J10 K0", "arc 0 10 10 around 10 0 cw"},
    {"3.4.3.1 G19 with R", "F60 G19 G3 Y10 Z10 R10", "arc 0 10 10 around 0 10 ccw"},
    {"3.4.3.2 the end may be the start", "F60 G2 X0 I5", "arc 0 0 0 around 5 0 cw"},
    {"3.4.3 G2 is optional while it is active", "F60 G2 X20 I10\nX40 I10",
     "arc 20 0 0 around 10 0 cw; arc 40 0 0 around 30 0 cw"},
    {"set-up: I J K are positions", "F60 G90.1 G2 X10 Y10 I10 J0", "arc 10 10 0 around 10 0 cw"},
    {"set-up: I J K are distances", "F60 G90.1\nG0 X7\nG91.1 G2 X9 I1",
     "rapid 7 0 0; arc 9 0 0 around 8 0 cw"},

    {"3.4.4 G4 keeps the axes still for P seconds", "G4 P1.5", "dwell 1.5"},
    {"3.4.4 G4 P0", "G4 P0", "dwell 0"},
    {"3.4.5 G10 L2 sets the named coordinates", "G10 L2 P1 x 3.5 y 17.2\nG0 X0 Y0 Z0",
     "rapid 3.5 17.2 0"},
    {"3.4.5 the system may be inactive", "G10 L2 P2 X5\nG0 X1\nG55 X1", "rapid 1 0 0; rapid 6 0 0"},
    // G92 X10 at 0 is an offset of -10: X10 is at 5 - 10 + 10.
    {"3.4.5 G92 stays in effect", "G92 X10\nG10 L2 P1 X5\nG0 X10", "rapid 5 0 0"},
    {"3.4.5 G10 L20 sets zero relative to the position", "G0 X7\nG10 L20 P1 X1\nX0",
     "rapid 7 0 0; rapid 6 0 0"},
    {"3.4.7 G20 is inches", "G20 G0 X1", "rapid 25.4 0 0"},
    {"3.4.7 G21 is millimetres", "G20\nG21 G0 X1", "rapid 1 0 0"},
    {"3.4.7 G70 is G20", "G70 G0 X1", "rapid 25.4 0 0"},
    {"3.4.7 G71 is G21", "G70\nG71 G0 X1", "rapid 1 0 0"},
    {"3.4.8 G28 goes home", "#5161=1 #5162=2 #5163=3\nG28", "rapid 1 2 3"},
    {"3.4.8 G28 goes by way of the programmed position", "#5161=1 #5162=2 #5163=3\nG28 Z9",
     "rapid 0 0 9; rapid 0 0 3"},
    {"3.4.8 G30 goes to the second position", "#5181=1 #5182=2 #5183=3\nG30", "rapid 1 2 3"},
    {"3.4.8 G30 goes by way of the programmed position", "#5181=1\nG30 X9",
     "rapid 9 0 0; rapid 1 0 0"},
    {"3.4.9 G33 moves K per revolution", "M3\nG33 Z-10 K1.5", "spindle cw; thread 0 0 -10 by 1.5"},
    {"3.4.9 G33.1 reverses the spindle and comes back", "M3\nG33.1 Z-10 K1.5",
     "spindle cw; thread 0 0 -10 by 1.5; spindle ccw; thread 0 0 0 by 1.5; spindle cw"},
    {"3.4.10.1 G38.2 moves straight to the point", "F60\nG38.2 X3 Z-10", "probe 3 0 -10"},
    {"3.4.10.1 rotary words that turn nothing are allowed", "F60\nG38.2 Z-10 A0", "probe 0 0 -10"},
    {"3.4.10.1 G53 G38.2 moves in machine coordinates", "F60 G92 Z50\nG53 G38.2 Z-10",
     "probe 0 0 -10"},

    // Appendix A.2: the straight entry move is the leg of a right triangle whose hypotenuse is the
    // programmed move, 5, and whose other leg is the radius, 3: 4 long, to (4 * 4/5, 4 * 3/5).
    {"3.4.11 G41: left of the path, tool D", "#5501=6\nF60 G41 D1 G1 X5", "feed 3.2 2.4 0"},
    {"3.4.11 G42: right of the path", "#5501=6\nF60 G42 D1 G1 X5", "feed 3.2 -2.4 0"},
    {"3.4.11 without D it is the spindle's tool", "#5501=6\nT1 M6\nF60 G41 G1 X5",
     "feed 3.2 2.4 0"},
    {"3.4.11 G41.1: D is the diameter", "F60 G41.1 D6 G1 X5", "feed 3.2 2.4 0"},
    {"3.4.11 G42.1: D is the diameter", "F60 G42.1 D6 G1 X5", "feed 3.2 -2.4 0"},
    {"3.4.11 D0 is radius 0", "F60 G41 D0 G1 X5", "feed 5 0 0"},
    {"A.2 the move behind G40 starts where the tool is", "F60 G41.1 D6 G1 X5\nG40 G0 X20",
     "feed 3.2 2.4 0; rapid 20 2.4 0"},
    {"3.4.11 G40 where it is off", "G40 G0 X1", "rapid 1 0 0"},

    {"3.4.12 G43: the tool in the spindle", "#5401=10\nT1 M6\nG43 G0 Z1", "rapid 0 0 11"},
    {"3.4.12 G43 follows the next tool", "#5401=10 #5402=20\nT1 M6 G43\nT2 M6\nG0 Z1",
     "rapid 0 0 21"},
    {"3.4.12 G43 H: a tool of the table", "#5401=10\nG43 H1 G0 Z1", "rapid 0 0 11"},
    {"3.4.12 G43 H does not follow the next tool", "#5401=10 #5402=20\nG43 H1\nT2 M6\nG0 Z1",
     "rapid 0 0 11"},
    {"3.4.12 the X offset, for turning", "#5601=4\nG43 H1 G0 X1", "rapid 5 0 0"},
    {"3.4.12 G43.1: I and K", "G43.1 I2 K30\nG0 X1 Z1", "rapid 3 0 31"},
    {"3.4.12 G49: none", "G43.1 K30\nG49 G0 Z1", "rapid 0 0 1"},
    {"3.4.13 G51 P about I J", "G51 P2 I1 J1\nG0 X2 Y3", "rapid 3 5 0"},  // 1 + 2 (2 - 1) …
    {"3.4.13 G51 X Y", "G51 X2 Y3\nG0 X2 Y2", "rapid 4 6 0"},
    {"3.4.13 G50", "G51 P2\nG50 G0 X1", "rapid 1 0 0"},
    {"3.4.13 G51's point is also that of G68", "G51 P1 I1 J1\nG68 R90\nG0 X2 Y1", "rapid 1 2 0"},
    {"3.4.14 G53 with G0", "G92 X5\nG53 G0 X1", "rapid 1 0 0"},
    {"3.4.14 G53 with G1", "F60 G92 X5\nG1 G53 X1", "feed 1 0 0"},
    {"3.4.14 G53 is not modal", "G92 X5\nG53 G0 X1\nX1", "rapid 1 0 0; rapid -4 0 0"},
    {"3.4.15 G54", "G10 L2 P1 X10\nG54 G0 X1", "rapid 11 0 0"},
    {"3.4.15 G55", "G10 L2 P2 X20\nG55 G0 X1", "rapid 21 0 0"},
    {"3.4.15 G56", "G10 L2 P3 X30\nG56 G0 X1", "rapid 31 0 0"},
    {"3.4.15 G57", "G10 L2 P4 X40\nG57 G0 X1", "rapid 41 0 0"},
    {"3.4.15 G58", "G10 L2 P5 X50\nG58 G0 X1", "rapid 51 0 0"},
    {"3.4.15 G59", "G10 L2 P6 X60\nG59 G0 X1", "rapid 61 0 0"},
    {"3.4.15 G59.1", "G10 L2 P7 X70\nG59.1 G0 X1", "rapid 71 0 0"},
    {"3.4.15 G59.2", "G10 L2 P8 X80\nG59.2 G0 X1", "rapid 81 0 0"},
    {"3.4.15 G59.3", "G10 L2 P9 X90\nG59.3 G0 X1", "rapid 91 0 0"},
    // (2, 1) about (1, 1) by a quarter counter-clockwise.
    {"3.4.18 G68 R X Y", "G68 R90 X1 Y1\nG0 X2 Y1", "rapid 1 2 0"},
    {"3.4.18 negative R is clockwise", "G68 R-90 X1 Y1\nG0 X2 Y1", "rapid 1 0 0"},
    {"table 3-3 G69", "G68 R90\nG69 G0 X1", "rapid 1 0 0"},
    {"3.4.19 G76: one pass at I - K", "G18 M3\nG0 X20 Z20\nG76 P1 Z10 I15 J1 K1",
     "spindle cw; rapid 20 0 20; rapid 14 0 20; thread 14 0 10 by 1; rapid 20 0 10; rapid 20 0 20"},
    {"3.4.20 G80 ends the motion mode, G0 begins it again", "F60 G81 Z-1 R0\nG80\nG0 X1",
     "feed 0 0 -1; rapid 0 0 0; rapid 1 0 0"},

    {"3.4.21.1 first up to R, once", "F60 G81 X1 Z-1 R2 L2",
     "rapid 0 0 2; rapid 1 0 2; feed 1 0 -1; rapid 1 0 2; feed 1 0 -1; rapid 1 0 2"},
    {"3.4.21.2 G81", "F60 G0 X1 Y2 Z3\nG90 G81 G98 X4 Y5 Z1.5 R2.8",
     "rapid 1 2 3; rapid 4 5 3; rapid 4 5 2.8; feed 4 5 1.5; rapid 4 5 3"},
    {"3.4.21.2 G81 with G91 and L", "F60 G0 X1 Y2 Z3\nG91 G81 G98 X4 Y5 Z-0.6 R1.8 L3",
     "rapid 1 2 3; rapid 1 2 4.8; rapid 5 7 4.8; feed 5 7 4.2; rapid 5 7 4.8; rapid 9 12 4.8; "
     "feed 9 12 4.2; rapid 9 12 4.8; rapid 13 17 4.8; feed 13 17 4.2; rapid 13 17 4.8"},
    {"3.4.21.3 G82", "F60 G82 Z-1 R0 P0.5", "feed 0 0 -1; dwell 0.5; rapid 0 0 0"},
    {"3.4.21.4 G83: out to clear Z after each Q", "F60 G83 Z-3 R0 Q2",
     "feed 0 0 -2; rapid 0 0 0; rapid 0 0 -1.75; feed 0 0 -3; rapid 0 0 0"},
    {"3.4.21.5 G73: back by Q", "F60 G73 Z-5 R1 Q3",
     "rapid 0 0 1; feed 0 0 -2; rapid 0 0 1; rapid 0 0 -1.75; feed 0 0 -5; rapid 0 0 1"},
    {"3.4.21.6 G84: F per revolution, back reversed", "M3 S600\nG84 Z-5 R0 F1",
     "spindle cw; thread 0 0 -5 by 1; spindle ccw; thread 0 0 0 by 1; spindle cw"},
    {"3.4.21.7 G74: left-hand", "M4 S600\nG74 Z-5 R0 F1",
     "spindle ccw; thread 0 0 -5 by 1; spindle cw; thread 0 0 0 by 1; spindle ccw"},
    {"3.4.21.8 G85: feed out", "F60 G85 Z-1 R0", "feed 0 0 -1; feed 0 0 0"},
    {"3.4.21.9 G86: dwell, spindle off, rapid out, spindle on", "F60 M3\nG86 Z-1 R0 P1",
     "spindle cw; feed 0 0 -1; dwell 1; spindle off; rapid 0 0 0; spindle cw"},
    {"3.4.21.10 G87, its thirteen steps", "F60 M3\nG87 Z-9 R0 I2 J1 K-5",
     "spindle cw; rapid 2 1 0; orient; rapid 2 1 -9; rapid 0 0 -9; spindle cw; feed 0 0 -5; "
     "feed 0 0 -9; orient; rapid 2 1 -9; rapid 2 1 0; rapid 0 0 0; spindle cw"},
    {"3.4.21.11 G88: dwell, spindle off, stop, spindle on", "F60 M3\nG88 Z-1 R0 P1",
     "spindle cw; feed 0 0 -1; dwell 1; spindle off; stop; rapid 0 0 0; spindle cw"},
    {"3.4.21.12 G89: dwell, feed out", "F60 G89 Z-1 R0 P1", "feed 0 0 -1; dwell 1; feed 0 0 0"},
    {"3.4.21 words stay while the cycle repeats", "F60 G81 X1 Z-1 R0\nX2",
     "rapid 1 0 0; feed 1 0 -1; rapid 1 0 0; rapid 2 0 0; feed 2 0 -1; rapid 2 0 0"},
    {"3.4.21 L does not stay", "F60 G81 Z-1 R0 L2\nX1",
     "feed 0 0 -1; rapid 0 0 0; feed 0 0 -1; rapid 0 0 0; rapid 1 0 0; feed 1 0 -1; rapid 1 0 0"},
    {"3.4.21 along Y in G18", "F60 G18 G81 X1 Z2 Y-3 R1",
     "rapid 0 1 0; rapid 1 1 2; feed 1 -3 2; rapid 1 1 2"},
    {"3.4.21 along X in G19", "F60 G19 G81 Y1 Z2 X-3 R1",
     "rapid 1 0 0; rapid 1 1 2; feed -3 1 2; rapid 1 1 2"},
    {"3.4.21 rotary words that turn nothing are allowed", "F60 G81 Z-1 R0 A0",
     "feed 0 0 -1; rapid 0 0 0"},

    {"3.4.22 G91: increments", "G91 G0 X1\nX1", "rapid 1 0 0; rapid 2 0 0"},
    {"3.4.22 G90: positions", "G91\nG90 G0 X1\nX1", "rapid 1 0 0; rapid 1 0 0"},
    {"3.4.22 I and J are increments in G90 too", "F60 G0 X5\nG90 G2 X7 I1",
     "rapid 5 0 0; arc 7 0 0 around 6 0 cw"},
    {"3.4.23 G92: the present point gets the coordinates", "G0 X4\nG92 X7\nX0",
     "rapid 4 0 0; rapid -3 0 0"},
    {"3.4.23 a second G92 adds up", "G0 X4\nG92 X7\nG92 X9\nX0", "rapid 4 0 0; rapid -5 0 0"},
    {"3.4.23 G91 does not matter", "G91 G0 X4\nG92 X7\nG90 X0", "rapid 4 0 0; rapid -3 0 0"},
    {"3.4.23 G92 acts in all systems", "G92 X10\nG55 G0 X0", "rapid -10 0 0"},
    {"3.4.23 G92.1 resets", "G92 X10\nG92.1\nG92.3\nG0 X0", "rapid 0 0 0"},
    {"3.4.23 G92.2 resets and keeps #5211", "G92 X10\nG92.2\nG0 X#5211", "rapid -10 0 0"},
    {"3.4.23 G92.3 sets from #5211", "G92 X10\nG92.2\nG92.3\nG0 X0", "rapid -10 0 0"},
    {"3.4.26 G98: to where the axis was", "F60 G0 Z5\nG98 G81 X1 Z-1 R2",
     "rapid 0 0 5; rapid 1 0 5; rapid 1 0 2; feed 1 0 -1; rapid 1 0 5"},
    {"3.4.26 G98 with R above that: to R", "F60 G98 G81 Z-1 R2",
     "rapid 0 0 2; feed 0 0 -1; rapid 0 0 2"},
    {"3.4.26 G99: to R", "F60 G0 Z5\nG99 G81 X1 Z-1 R2",
     "rapid 0 0 5; rapid 1 0 5; rapid 1 0 2; feed 1 0 -1; rapid 1 0 2"},
});

// Codes that say something else than a move.
constexpr auto kCommands = std::to_array<Row>({
    {"3.4.6 G17", "G18\nG17", "SELECT_PLANE(CANON_PLANE_XZ); SELECT_PLANE(CANON_PLANE_XY)"},
    {"3.4.6 G18", "G18", "SELECT_PLANE(CANON_PLANE_XZ)"},
    {"3.4.6 G19", "G19", "SELECT_PLANE(CANON_PLANE_YZ)"},
    {"3.4.7 G20 and G21", "G20\nG21",
     "USE_LENGTH_UNITS(CANON_UNITS_INCHES); USE_LENGTH_UNITS(CANON_UNITS_MM)"},
    {"3.4.16 G61", "G64\nG61",
     "SET_MOTION_CONTROL_MODE(CANON_CONTINUOUS); SET_MOTION_CONTROL_MODE(CANON_EXACT_PATH)"},
    {"3.4.16 G61 Q R", "G61 Q0.02 R3",
     "SET_MOTION_CONTROL_MODE(CANON_EXACT_PATH, Q0.020000, R3.000000)"},
    {"3.4.16 R0: look-ahead feed off", "G61 R0",
     "SET_MOTION_CONTROL_MODE(CANON_EXACT_PATH, R0.000000)"},
    {"table 3-4 G61.1", "G61.1", "SET_MOTION_CONTROL_MODE(CANON_EXACT_STOP)"},
    {"3.4.16 G64", "G64", "SET_MOTION_CONTROL_MODE(CANON_CONTINUOUS)"},
    {"3.4.16 G64 P Q R", "G64 P0.1 Q0.02 R3",
     "SET_MOTION_CONTROL_MODE(CANON_CONTINUOUS, P0.100000, Q0.020000, R3.000000)"},
    // F6: a move of 10 seconds.
    {"3.4.24 G93: 1/F minutes", "G93 F6", "SET_FEED_RATE(0.100000, INVERSE_TIME)"},
    {"3.4.24 G94: units per minute", "G93\nG94 F600", "SET_FEED_RATE(10.000000)"},
    {"3.4.24 G94 in inches", "G20\nG94 F60",
     "USE_LENGTH_UNITS(CANON_UNITS_INCHES); SET_FEED_RATE(25.400000)"},
    {"3.4.24 G95: units per revolution", "G95 F2", "SET_FEED_RATE(2.000000, PER_REVOLUTION)"},
    // 150 m/min = 2500 mm/s.
    {"3.4.25 G96 S D", "G96 S150 D1000", "SET_SURFACE_SPEED(2500.000000, D1000.000000)"},
    {"3.4.25 G97: rpm", "G96 S60\nG97 S500",
     "SET_SURFACE_SPEED(1000.000000); SET_SPINDLE_SPEED(500.000000)"},
    {"3.6.1 F", "F60", "SET_FEED_RATE(1.000000)"},
    {"3.6.2 S, the spindle turning or not", "S100\nM3\nS200",
     "SET_SPINDLE_SPEED(100.000000); START_SPINDLE_CLOCKWISE(); SET_SPINDLE_SPEED(200.000000)"},
    {"3.6.2 S0", "S0", "SET_SPINDLE_SPEED(0.000000)"},
    {"3.6.3 T before M6", "T3\nM6", "SELECT_TOOL(3); CHANGE_TOOL(3)"},
    {"3.6.3 T beside M6", "M6 T3", "SELECT_TOOL(3); CHANGE_TOOL(3)"},
    {"3.6.3 the last T counts", "T3\nT4\nM6", "SELECT_TOOL(3); SELECT_TOOL(4); CHANGE_TOOL(4)"},
    {"3.6.3 T0: no tool", "T0\nM6", "SELECT_TOOL(0); CHANGE_TOOL(0)"},
});

}  // namespace

std::span<const Row> cnc::interp::test::g_code_move_rows() { return kMoves; }
std::span<const Row> cnc::interp::test::g_code_command_rows() { return kCommands; }

TEST_CASE("G codes move as the manual says", "[conformance][GCO-2][GCO-3][GCO-8][CRD-1][CRD-2]") {
  const Row row = GENERATE(from_range(kMoves));
  INFO(row.rule << ": " << row.program);
  CHECK(moves_of(row.program) == row.expected);
}

TEST_CASE("G codes and words set what the manual says", "[conformance][GCO-6][GCO-7][GCO-13]") {
  const Row row = GENERATE(from_range(kCommands));
  INFO(row.rule << ": " << row.program);
  CHECK(commands_of(row.program) == row.expected);
}
