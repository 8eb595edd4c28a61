; macro.cnc - subroutines of this machine.
;
; The server loads this file beside every job, and user_macro.cnc (your own, if there is one) behind
; it: a sub in user_macro.cnc replaces the one of the same name here. Both are read again when they
; have changed. Lines outside of subs are not executed, except those that only set parameters.
;
; The machine calls by itself:
;   home_x ... home_c, home_all   when an axis, or the machine, is homed
;   change_tool                   at M6, where automatic tool change is on
;   user_reset                    after a reset
; The buttons user 1 to user 10 call user_1 ... user_10. A sub named like an M code (sub m3) takes
; the place of that code; within it the same code is the real one.
;
; Parameters that these subs keep (4000-4999 survive power-off):
;   #4100-#4105  grid of zhcmgrid        #4990  height of the probe plate
;   #4996        safe height of Z        #4997 #4998  place of the tool setter
;   #4999        height of the tool setter, where the tool length is zero
; Everything is in mm; X Y Z of #4996-#4999 are machine coordinates.

; --- homing ----------------------------------------------------------------------------------------

sub home_x
  home x
endsub

sub home_y
  home y
endsub

sub home_z
  home z
endsub

sub home_a
  home a
endsub

sub home_b
  home b
endsub

sub home_c
  home c
endsub

; Z first, to get the tool out of the way. Add the rotary axes of your machine.
sub home_all
  gosub home_z
  gosub home_x
  gosub home_y
endsub

; --- tool change -----------------------------------------------------------------------------------

; #5008 is the tool in the spindle, #5011 the one that is wanted, #5015 becomes 1 when it is there.
sub change_tool
  TCAGuard off
  m5
  #5015 = 0
  if [#5011 == #5008]
    msg "Tool "#5011" is in the spindle already"
    #5015 = 1
  else
    gosub drop_tool
    gosub pick_tool
  endif
  if [#5015 == 1]
    m6 t[#5011]
    if [#5011 <> 0]
      g43
    endif
  else
    errmsg "The tool change has failed"
  endif
  TCAGuard on
endsub

; By hand. Write the moves and outputs of your changer here and in pick_tool.
sub drop_tool
  if [#5397 == 0]
    g53 g0 z[#5113]
    if [#5008 <> 0]
      warnmsg "Take out tool "#5008", then resume"
    endif
  endif
endsub

sub pick_tool
  if [#5011 <> 0]
    warnmsg "Insert tool "#5011", then resume"
  endif
  #5015 = 1
endsub

; --- units -----------------------------------------------------------------------------------------

; The subs below are written in mm, and may be called while G20 is active. The travel of Z in either
; unit tells which it was: 1 for mm, 1/25.4 for inches.
sub to_millimetres
  #116 = [#5113 - #5103]
  g21
  #116 = [#116 / [#5113 - #5103]]
endsub

sub to_unit_before
  if [#116 < 0.5]
    g20
  endif
endsub

; --- tool length -----------------------------------------------------------------------------------

; Once for a machine: where the tool setter is. Tool 99 is the reference; enter its length in the
; tool table first (0 for the empty chuck).
sub calibrate_tool_setter
  gosub to_millimetres
  warnmsg "Check the length of the reference tool 99 in the tool table, then resume"
  warnmsg "Jog Z to the safe height for tool changes, then resume"
  #4996 = #5073
  warnmsg "Insert the reference tool, length "#5499", jog just above the tool setter, then resume"
  #4997 = #5071
  #4998 = #5072
  if [#5397 == 0]
    g38.2 g91 z-20 f30
    g90
    if [#5067 == 0]
      errmsg "The tool setter was not touched within 20 mm"
    endif
    #4999 = [#5053 - #5499]
    g0 g53 z#4996
  endif
  msg "Tool setter calibrated: safe height "#4996", X "#4997", Y "#4998", height "#4999
  gosub to_unit_before
endsub

; Measures a tool and stores its length and diameter in the tool table.
sub m_tool
  gosub to_millimetres
  if [[#4996 == 0] and [#4997 == 0] and [#4998 == 0] and [#4999 == 0]]
    errmsg "The tool setter is not calibrated: gosub calibrate_tool_setter"
  endif
  #5016 = #5008
  #5017 = 50
  #5018 = 3
  if [#5008 > 0]
    #5017 = #[5400 + #5008]
    #5018 = #[5500 + #5008]
  endif
  g0 g53 z#4996
  dlgmsg "Measure tool" "Tool number" 5016 "Approximate length" 5017 "Diameter" 5018
  if [[#5398 == 1] and [#5397 == 0]]
    if [[#5016 < 1] or [#5016 > 99]]
      errmsg "The tool number must be 1 to 99"
    endif
    g0 g53 x#4997 y#4998
    g0 g53 z[#4999 + 10 + #5017]
    g38.2 g91 z-20 f30
    g90
    g0 g53 z#4996
    if [#5067 == 0]
      errmsg "The tool setter was not touched: is the approximate length right?"
    endif
    #[5400 + #5016] = [#5053 - #4999]
    #[5500 + #5016] = #5018
    #[5600 + #5016] = 0
    msg "Tool "#5016" has length "#[5400 + #5016]
  endif
  gosub to_unit_before
endsub

; --- zero of the work piece ------------------------------------------------------------------------

; Z zero with a probe plate on the work piece, for the tool in the spindle.
sub zero_z
  gosub to_millimetres
  if [#4990 == 0]
    #4990 = 20
  endif
  dlgmsg "Z zero with the probe plate" "Height of the plate" 4990
  if [[#5398 == 1] and [#5397 == 0]]
    m5
    g38.2 g91 z-50 f100
    if [#5067 == 0]
      g90
      errmsg "The plate was not touched within 50 mm"
    endif
    g0 z2
    g38.2 z-4 f20
    g90
    if [#5067 == 0]
      errmsg "The plate was not touched a second time"
    endif
    g10 l20 p[#5220] z[#4990 + #5003 - #5063]
    g91 g0 z5
    g90
    msg "Z is zero at the top of the work piece"
  endif
  gosub to_unit_before
endsub

; --- height map ------------------------------------------------------------------------------------

; Probes a grid from work X0 Y0 on, to and fro, and stores the points. Z values are work coordinates.
sub zhcmgrid
  gosub to_millimetres
  if [#4100 == 0]
    #4100 = 10   ; points along X
    #4101 = 5    ; points along Y
    #4102 = 40   ; Z to travel at
    #4103 = 10   ; Z to probe down to
    #4104 = 1    ; distance of the points
    #4105 = 100  ; feed of probing
  endif
  #110 = 0       ; column
  #111 = 0       ; row
  #112 = 0       ; points missed
  #113 = 0       ; points added
  #114 = 1       ; direction along X
  dlgmsg "gridMeas" "nx" 4100 "ny" 4101 "maxZ" 4102 "minZ" 4103 "gridSize" 4104 "Feed" 4105
  if [#5398 == 1]
    g90
    g0 z[#4102]
    g0 x0 y0
    ZHCINIT [#4104] [#4100] [#4101]
    while [#111 < #4101]
      #115 = #4100
      while [#115 > 0]
        g0 z[#4102]
        g0 x[#110 * #4104] y[#111 * #4104]
        if [#5397 == 0]
          g38.2 z[#4103] f[#4105]
          if [#5067 == 1]
            ZHCADDPOINT
            #113 = [#113 + 1]
          else
            msg "No touch at column "[#110 + 1]", row "[#111 + 1]
            #112 = [#112 + 1]
          endif
        endif
        #115 = [#115 - 1]
        if [#115 > 0]
          #110 = [#110 + #114]
        endif
      endwhile
      #114 = [0 - #114]
      #111 = [#111 + 1]
    endwhile
    g0 z[#4102]
    ZHCS "zHeightCompTable.txt"
    msg "Height map: "#113" points added, "#112" missed"
  else
    msg "Height map cancelled"
  endif
  gosub to_unit_before
endsub

; --- buttons ---------------------------------------------------------------------------------------

sub user_1
  gosub zero_z
endsub

sub user_2
  gosub m_tool
endsub

sub user_3
  msg "user_3 is free: write it in user_macro.cnc"
endsub

sub user_4
  msg "user_4 is free: write it in user_macro.cnc"
endsub

sub user_5
  msg "user_5 is free: write it in user_macro.cnc"
endsub

sub user_6
  msg "user_6 is free: write it in user_macro.cnc"
endsub

sub user_7
  msg "user_7 is free: write it in user_macro.cnc"
endsub

sub user_8
  msg "user_8 is free: write it in user_macro.cnc"
endsub

sub user_9
  msg "user_9 is free: write it in user_macro.cnc"
endsub

sub user_10
  msg "user_10 is free: write it in user_macro.cnc"
endsub

; After a reset. Nothing to do for this machine; for drives that are reset by an output:
;   m54 p1
;   g4 p0.1
;   m55 p1
sub user_reset
endsub
