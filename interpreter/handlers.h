// One function per code (or per family of codes that differ in one value): it reads its words from
// the block, checks their values, changes the modal state and emits canonical commands. A handler
// that refuses may leave things half done: Execution restores the state of before the line.
#pragma once

#include "interpreter/refusal.h"

namespace cnc::interp {

class Execution;

// feed and speed (feed_and_speed.cpp)
Accepted set_feed_mode(Execution& x);     // G93 G94 G95
Accepted set_feed(Execution& x);          // F
Accepted set_spindle_mode(Execution& x);  // G96 G97
Accepted set_speed(Execution& x);         // S

// words and comments (machine_functions.cpp)
Accepted select_tool(Execution& x);
Accepted show_comment(Execution& x);

// motion (motion.cpp)
Accepted rapid_move(Execution& x);     // G0
Accepted feed_move(Execution& x);      // G1
Accepted arc_move(Execution& x);       // G2 G3
Accepted cancel_motion(Execution& x);  // G80
Accepted dwell(Execution& x);          // G4
Accepted go_home(Execution& x);        // G28 G30

// motion that follows the spindle (spindle_moves.cpp, threading.cpp)
Accepted spindle_move(Execution& x);                 // G33
Accepted spindle_move_there_and_back(Execution& x);  // G33.1
Accepted threading_cycle(Execution& x);              // G76

// probing (probing.cpp)
Accepted probe(Execution& x);  // G38.2

// canned cycles (canned_cycles.cpp)
Accepted canned_cycle(Execution& x);  // G73 G74 G81 … G89

// modes (modes.cpp)
Accepted select_plane(Execution& x);                // G17 G18 G19
Accepted use_length_unit(Execution& x);             // G20 G21 G70 G71
Accepted cancel_cutter_compensation(Execution& x);  // G40
Accepted set_path_control(Execution& x);            // G61 G61.1 G64
Accepted switch_contouring(Execution& x);           // M21 M22 of pscnc
Accepted set_distance_mode(Execution& x);           // G90 G91
Accepted set_arc_distance_mode(Execution& x);       // G90.1 G91.1
Accepted set_retract_mode(Execution& x);            // G98 G99
Accepted use_machine_coordinates(Execution& x);     // G53

// rotation and scaling (rotation.cpp)
Accepted rotate(Execution& x);           // G68
Accepted cancel_rotation(Execution& x);  // G69
Accepted scale(Execution& x);            // G51
Accepted cancel_scaling(Execution& x);   // G50

// offsets (offsets.cpp)
Accepted set_coordinate_system(Execution& x);  // G10 L2 L20
Accepted use_tool_length(Execution& x);        // G43
Accepted use_length_words(Execution& x);       // G43.1
Accepted cancel_tool_length(Execution& x);     // G49
Accepted select_work_system(Execution& x);     // G54 … G59.3
Accepted set_g92_offset(Execution& x);         // G92
Accepted clear_g92_offset(Execution& x);       // G92.1
Accepted suspend_g92_offset(Execution& x);     // G92.2
Accepted restore_g92_offset(Execution& x);     // G92.3

// machine functions (machine_functions.cpp)
Accepted stop_program(Execution& x);      // M0 M1
Accepted end_program(Execution& x);       // M2 M30
Accepted turn_spindle(Execution& x);      // M3 M4 M5
Accepted change_tool(Execution& x);       // M6
Accepted switch_coolant(Execution& x);    // M7 M8 M9
Accepted switch_overrides(Execution& x);  // M48 M49

}  // namespace cnc::interp
