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
Accepted select_plane(Execution& x);             // G17 G18 G19
Accepted use_length_unit(Execution& x);          // G20 G21 G70 G71
Accepted set_path_control(Execution& x);         // G61 G61.1 G64
Accepted switch_contouring(Execution& x);        // M21 M22 of pscnc
Accepted set_distance_mode(Execution& x);        // G90 G91
Accepted set_arc_distance_mode(Execution& x);    // G90.1 G91.1
Accepted set_retract_mode(Execution& x);         // G98 G99
Accepted use_machine_coordinates(Execution& x);  // G53

// cutter compensation (cutter_compensation.cpp)
Accepted begin_cutter_compensation(Execution& x);   // G41 G42 G41.1 G42.1
Accepted cancel_cutter_compensation(Execution& x);  // G40

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
Accepted stop_program(Execution& x);    // M0 M1 M60
Accepted end_program(Execution& x);     // M2 M30
Accepted turn_spindle(Execution& x);    // M3 M4 M5
Accepted change_tool(Execution& x);     // M6
Accepted switch_coolant(Execution& x);  // M7 M8 M9

// overrides (override_functions.cpp)
Accepted switch_overrides(Execution& x);       // M48 M49
Accepted set_override(Execution& x);           // M50 M51
Accepted switch_override_input(Execution& x);  // M52
Accepted switch_hold_input(Execution& x);      // M53

// inputs, outputs, clamp (io_functions.cpp)
Accepted switch_clamp(Execution& x);           // M26 M27
Accepted set_output(Execution& x);             // M54
Accepted clear_output(Execution& x);           // M55
Accepted read_input(Execution& x);             // M56
Accepted switch_drives(Execution& x);          // M80 M81
Accepted switch_spindle_output(Execution& x);  // M84 … M87

// heads (head_functions.cpp)
Accepted select_head(Execution& x);  // M90 M91 M92 M93 M95 M97

// torch and 3D printer (process_functions.cpp)
Accepted switch_torch_height(Execution& x);    // M20 M21
Accepted set_torch_height(Execution& x);       // M22 M23
Accepted scale_axis(Execution& x);             // M100
Accepted set_temperature(Execution& x);        // M104 M109 M140 M190
Accepted set_temperature_limit(Execution& x);  // M143
Accepted set_fan(Execution& x);                // M106 M107
Accepted switch_heaters_off(Execution& x);     // M1 of a 3D printer

}  // namespace cnc::interp
