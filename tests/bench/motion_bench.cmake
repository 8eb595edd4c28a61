cnc_bench(motion_bench SOURCES motion_bench.cpp LINKS cnc_motion)
