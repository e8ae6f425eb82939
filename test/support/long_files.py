"""Which files of tests are to be begun first."""

from __future__ import annotations

#: Files of more than half a minute of processor time, the dearest first: begun late, one of them is what a worker
#: still has to do alone when the others have ended.
LONG = (
    "test_page_commands.py",
    "diagnosis/pose/test_hidden_faults.py",
    "diagnosis/test_same_answer.py",
    "nodes/test_afternoon.py",
    "nodes/test_cells_apart.py",
    "nodes/test_deaths.py",
    "nodes/test_two_robots.py",
    "diagnosis/runs/test_run_series.py",
    "nodes/test_ended_runs.py",
    "nodes/test_door_sensors.py",
    "nodes/test_stepped_clock.py",
    "diagnosis/pose/test_points.py",
    "test_readme.py",
    "nodes/test_model_monitor.py",
    "diagnosis/parts/test_shift_diagnosis.py",
    "nodes/test_two_tools_in_cell.py",
    "nodes/test_doors.py",
    "diagnosis/parts/test_small_effects.py",
    "nodes/test_web_services.py",
    "nodes/test_hostile_messages.py",
    "nodes/test_killed_nodes.py",
    "diagnosis/law/test_names_beside_laws.py",
    "diagnosis/parts/test_random_shift.py",
    "diagnosis/law/test_hidden_laws.py",
    "simulation/judge/test_shipped_doors.py",
    "diagnosis/loading/test_hidden_effects.py",
    "nodes/test_refusals.py",
    "operator/test_page_process.py",
    "simulation/judge/test_manner.py",
    "diagnosis/motion/test_kr300.py",
    "nodes/test_spindle_load.py",
    "diagnosis/pose/test_ur10.py",
    "localization/test_covariance.py",
    "nodes/test_tool_wear.py",
    "monitor/test_watch.py",
    "monitor/test_runs_watch.py",
)
