"""Every module has the test file of its path, or stands here with the one that exercises it instead.

The lists only get shorter: a module that gets a file of its own goes from them.
"""

from __future__ import annotations

import ast
from functools import cache
from pathlib import Path

import pytest
from repository import ROOT

# test file below tests/ -> what it exercises beside the module that it is named after
EXERCISED_BY = {
    "app/live/test_dds_link.py": {
        "algorithms.files.bags.message_writing",
        "app.live.dds_types",
        "app.live.message_fields",
        "app.live.ros_link",
    },
    "algorithms/fleets/test_living_merge.py": {
        "algorithms.fleets.live_answer",
        "algorithms.fleets.live_sightings",
    },
    "app/live/test_live_run.py": {
        "app.live.live_publisher",
        "app.live.sighting_sources",
        "app.live.simulation",
    },
    "app/cli/commands/test_live.py": {
        "app.cli.live_arguments",
        "app.live.search_thread",
    },
    "app/cli/commands/test_simulate.py": {
        "app.live.bag_writing",
    },
    "app/live/watch/test_live_watch.py": {
        "app.live.watch.running_robots",
    },
    "app/live/watch/test_published_maps.py": {
        "app.live.watch.robot_network",
    },
    "browser/test_live_page.py": {
        "app.page.live.live_controller",
        "app.page.live.live_panel",
        "app.page.live.network_controller",
        "app.page.live.network_panel",
    },
    "app/live/test_map_source.py": {
        "app.live.live_frames",
    },
    "algorithms/files/bags/test_map_messages.py": {
        "algorithms.files.bags.message_types",
    },
    "app/cli/commands/test_bag.py": {
        "algorithms.files.bags.bag_summary",
        "app.cli.bag_arguments",
    },
    "algorithms/detection/test_svm_training.py": {
        "algorithms.detection.svm_detector",
    },
    "algorithms/detection/test_footprint.py": {
        "algorithms.detection.footprint_fit",
    },
    "algorithms/detection/test_robot_sighting.py": {
        "algorithms.detection.map_walls",
    },
    "app/cli/commands/test_observe.py": {
        "app.cli.sensor_arguments",
    },
    "algorithms/files/test_bad_files.py": {
        "algorithms.common.errors",
        "algorithms.files.yaml_fields",
    },
    "algorithms/files/test_odd_yaml.py": {
        "algorithms.files.text_loader",
    },
    "algorithms/files/test_case_folder.py": {
        "algorithms.files.observation_file",
        "algorithms.files.truth_file",
    },
    "algorithms/files/test_cell_rules.py": {
        "algorithms.files.images.image_decoder",
        "algorithms.files.images.netpbm",
        "algorithms.files.images.thresholds",
    },
    "algorithms/maps/test_map_fusion.py": {
        "algorithms.maps.robots",
    },
    "algorithms/methods/test_merge_result.py": {
        "algorithms.methods.shared_stages",
    },
    "algorithms/methods/test_proven.py": {
        "algorithms.methods.spectra_answer",
        "algorithms.methods.steps",
    },
    "algorithms/methods/test_rivals.py": {
        "algorithms.methods.baselines.bilateral",
        "algorithms.methods.baselines.carpin_spectra",
        "algorithms.methods.baselines.distance_image",
        "algorithms.methods.baselines.feature_detectors",
        "algorithms.methods.baselines.feature_matching",
        "algorithms.methods.baselines.mse_registration",
        "algorithms.methods.baselines.overlap_error",
        "algorithms.methods.baselines.phase_correlation",
        "algorithms.methods.registry",
    },
    "algorithms/methods/test_spectra_method.py": {
        "algorithms.methods.spectra_config",
        "algorithms.methods.spectra_stages",
    },
    "algorithms/observations/test_priors.py": {
        "algorithms.observations.sighted_ring",
    },
    "algorithms/observations/test_search_window.py": {
        "algorithms.optimisation.search_box",
    },
    "algorithms/optimisation/test_branch_and_bound.py": {
        "algorithms.optimisation.transform_lattice",
    },
    "algorithms/optimisation/test_optimiser.py": {
        "algorithms.optimisation.monte_carlo",
        "algorithms.optimisation.particle_swarm",
    },
    "algorithms/files/test_fleet_file.py": {
        "algorithms.files.fleet_truth_file",
    },
    "algorithms/simulator/test_hardships.py": {
        "algorithms.simulator.changes",
        "algorithms.simulator.odometry_drift",
        "algorithms.simulator.wear",
    },
    "algorithms/simulator/test_simulator.py": {
        "algorithms.simulator.buildings.apartment",
        "algorithms.simulator.buildings.building_types",
        "algorithms.simulator.buildings.corridor",
        "algorithms.simulator.buildings.floor_plan",
        "algorithms.simulator.buildings.furniture",
        "algorithms.simulator.buildings.office",
        "algorithms.simulator.buildings.warehouse",
        "algorithms.simulator.lidar",
        "algorithms.simulator.path_planning",
        "algorithms.simulator.portable_random",
        "algorithms.simulator.robot",
        "algorithms.simulator.room_tours",
        "algorithms.simulator.fleets.sample_fleets",
        "algorithms.simulator.samples",
        "algorithms.simulator.scenario",
        "algorithms.simulator.sighting",
        "algorithms.simulator.wrong_pairs",
    },
    "algorithms/simulator/views/interiors/test_interior.py": {
        "algorithms.simulator.views.interiors.free_floor",
        "algorithms.simulator.views.interiors.furnishings",
        "algorithms.simulator.views.interiors.style",
    },
    "algorithms/simulator/views/rendering/test_ray_casting.py": {
        "algorithms.simulator.views.rendering.solid_hits",
    },
    "algorithms/simulator/views/surfaces/test_patterns.py": {
        "algorithms.simulator.views.surfaces.face_patterns",
        "algorithms.simulator.views.surfaces.floor_patterns",
        "algorithms.simulator.views.surfaces.materials",
        "algorithms.simulator.views.surfaces.noise",
        "algorithms.simulator.views.surfaces.pictures",
    },
    "algorithms/simulator/views/test_camera_image.py": {
        "algorithms.simulator.views.light",
        "algorithms.simulator.views.projection",
        "algorithms.simulator.views.rendering.eye",
        "algorithms.simulator.views.rendering.gloss",
        "algorithms.simulator.views.rendering.seen_points",
        "algorithms.simulator.views.rendering.shading",
        "algorithms.simulator.views.solids",
        "algorithms.simulator.views.view_scene",
    },
    "algorithms/simulator/views/test_robot_scan.py": {
        "algorithms.simulator.views.reflections",
    },
    "algorithms/simulator/views/test_robot_views.py": {
        "algorithms.simulator.views.clutter",
        "algorithms.simulator.views.hardships",
        "algorithms.simulator.views.robot_poster",
        "algorithms.simulator.views.robot_sensors",
        "algorithms.simulator.views.stage",
    },
    "algorithms/spectra/test_hough_spectra.py": {
        "algorithms.spectra.candidates",
    },
    "algorithms/verdict/test_wall_evidence.py": {
        "algorithms.verdict.slipping_patches",
    },
    "algorithms/verdict/test_whole_maps.py": {
        "algorithms.verdict.ranking",
    },
    "app/cli/commands/test_merge.py": {
        "app.cli.output_arguments",
        "app.system.data_paths",
        "app.system.hardware",
    },
    "app/cli/commands/test_serve.py": {
        "app.cli.open_browser",
    },
    "app/cli/commands/test_sweep.py": {
        "app.cli.commands.compare",
        "app.cli.progress_bar",
        "app.evaluation.comparison_files",
        "app.evaluation.table_files",
        "app.evaluation.sweep.sweep_files",
    },
    "app/cli/test_main.py": {
        "app.cli.argument_parser",
        "app.cli.map_arguments",
        "app.cli.setting_flags",
    },
    "app/drawing/scene/test_search_symbols.py": {
        "app.drawing.draw_items",
    },
    "app/drawing/scene/test_zoom_crop.py": {
        "app.drawing.scene.grid_image",
    },
    "app/drawing/test_legend.py": {
        "app.drawing.palette",
    },
    "app/evaluation/test_dataset_evaluation.py": {
        "app.cli.commands.evaluate",
    },
    "app/evaluation/test_figures.py": {
        "app.evaluation.comparison_figure",
        "app.evaluation.figure_style",
        "app.evaluation.sweep.sweep_figure",
    },
    "app/evaluation/sweep/test_parameter_sweep.py": {
        "app.evaluation.sweep.checkpoint",
        "app.system.version",
    },
    "app/jobs/test_executor.py": {
        "app.cli.executor_flags",
        "app.jobs.process_executor",
    },
    "app/jobs/test_forked_start.py": {
        "app.jobs.warm_up",
    },
    "app/jobs/test_job_thread.py": {
        "app.jobs.runner",
        "app.model.merge_job",
        "app.model.playback",
    },
    "app/jobs/test_worker_pool.py": {
        "app.jobs.incremental_pickle",
        "app.jobs.worker_process",
        "app.system.memory",
    },
    "app/model/test_contradiction_text.py": {
        "app.drawing.scene.map_comparison",
    },
    "app/model/sighting/test_sensor_files.py": {
        "app.model.sighting.look_settings",
    },
    "app/model/test_settings.py": {
        "algorithms.common.setting_bounds",
    },
    "app/model/test_status_text.py": {
        "app.model.objective_label",
        "app.model.step_table",
        "app.model.run_state",
    },
    "app/page/lesson/figures/test_figure_registry.py": {
        "app.page.lesson.figures.figure_slider",
        "app.page.lesson.figures.map_figures",
        "app.page.lesson.figures.search_figures",
        "app.page.lesson.figures.spectra_figures",
        "app.page.lesson.figures.verdict_figure",
        "app.drawing.svg.svg_canvas",
    },
    "app/page/lesson/figures/test_sighting_figure.py": {
        "app.page.lesson.figures.camera_figure",
        "app.page.lesson.figures.laser_figure",
        "app.page.lesson.figures.poster_figure",
    },
    "app/page/lesson/test_sighting_look.py": {
        "app.page.lesson.sighting_numbers",
    },
    "app/page/lesson/figures/test_fit_figure.py": {
        "app.drawing.svg.svg_grip",
    },
    "app/page/lesson/figures/test_chain_figure.py": {
        "app.page.lesson.chain_runs",
    },
    "app/page/lesson/test_handout.py": {
        "app.page.lesson.whole_lesson",
    },
    "app/page/lesson/test_lesson_controller.py": {
        "app.page.lesson.lesson_work",
    },
    "app/page/lesson/museum/test_museum_controller.py": {
        "app.page.lesson.museum.exhibit_samples",
        "app.page.lesson.museum.exhibit_texts",
    },
    "app/page/panels/test_panels.py": {
        "app.page.editing.observation_panel",
        "app.page.panels.html_widgets",
        "app.page.panels.result_panel",
        "app.model.merge_inputs",
        "app.report.result_rows",
    },
    "algorithms/fleets/test_fleet_merge.py": {
        "algorithms.observations.fleet",
    },
    "app/evaluation/test_fleet_evaluation.py": {
        "app.cli.evaluated_fleets",
    },
    "app/report/test_fleet_files.py": {
        "app.cli.commands.fleet",
        "app.report.fleet_report",
    },
    "app/report/test_suggestion_files.py": {
        "app.page.panels.suggestions_html",
        "app.report.suggestion_text",
    },
    "browser/test_fleet_page.py": {
        "app.page.fleet.fleet_controller",
        "app.page.fleet.fleet_display",
        "app.page.fleet.fleet_panel",
        "app.page.fleet.fleet_run_controller",
        "app.page.fleet.sample_robots",
    },
    "browser/test_hand.py": {
        "app.page.editing.knowledge_panel",
    },
    "browser/test_outcomes.py": {
        "app.page.editing.suggestion_controller",
    },
    "app/model/files/test_file_reader.py": {
        "app.model.files.bag_maps",
        "app.model.files.file_roles",
        "app.model.files.map_files",
        "app.model.files.map_slots",
    },
    "app/page/files/test_files_controller.py": {
        "app.page.files.files_html",
        "app.page.files.files_panel",
        "app.page.panels.uploaded_file",
    },
    "app/page/panels/test_threads.py": {
        "app.page.panels.settings_panel",
        "app.web.tab_messages",
    },
    "app/page/research/test_research.py": {
        "app.page.research.comparison_panel",
        "app.page.research.heatmap",
        "app.page.research.other_result",
        "app.page.research.sweep_curves",
        "app.page.research.sweep_request",
        "app.drawing.svg.thumbnail",
        "app.jobs.background_job",
    },
    "app/page/test_cancellable_task.py": {
        "app.system.cancellation",
    },
    "app/page/editing/test_correction_controller.py": {
        "app.page.editing.correction_panel",
    },
    "app/page/editing/test_names_controller.py": {
        "app.page.editing.names_panel",
    },
    "app/page/export/test_export_controller.py": {
        "app.drawing.scene.frame_symbols",
        "app.page.export.export_panel",
        "app.page.export.frame_panel",
    },
    "app/page/project/test_project_file.py": {
        "app.page.project.project_parts",
        "app.page.project.project_reader",
        "app.page.project.project_writer",
    },
    "app/page/undo/test_undo_history.py": {
        "app.page.undo.history_panel",
        "app.page.undo.page_snapshot",
        "app.web.session_store",
    },
    "app/report/replay/test_recorder.py": {
        "app.cli.commands.replay",
        "app.drawing.png",
        "app.drawing.scene.map_view",
        "app.drawing.scene.run_view",
        "app.report.replay.chart_recorder",
        "app.report.replay.html_page",
        "app.report.replay.image_recorder",
    },
    "app/report/test_html_report.py": {
        "app.drawing.svg.map_plot",
        "app.drawing.svg.verdict_bars",
        "app.report.report_figures",
    },
    "app/page/lesson/test_lesson_display.py": {
        "app.page.lesson.lesson_run",
    },
    "app/page/test_run_controller.py": {
        "app.page.tab",
    },
    "app/web/test_attacks.py": {
        "app.web.security.frame_limit",
        "app.web.security.message_schema",
        "app.web.viser_server",
    },
    "app/web/test_load.py": {
        "app.page.application",
        "app.page.editing.live_verdict",
        "app.page.lesson.lesson_panel",
        "app.page.lesson.museum.museum_panel",
        "app.page.notices",
        "app.page.page",
        "app.drawing.scene.tab_views",
        "app.page.page_display",
        "app.page.panel_set",
        "app.page.panels.chart_widgets",
        "app.page.panels.run_panel",
        "app.page.research.sweep_panel",
        "app.page.zoom_controller",
        "app.jobs.fair_semaphore",
        "app.jobs.preloaded",
        "app.model.view_modes",
        "app.web.cell_quota",
        "app.web.download",
    },
}
BY_NO_TEST = {}


@cache
def imports_of(path: Path) -> frozenset[str]:
    """Names of modules that a source may import, names within modules and names in quotes among them."""
    found: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            found |= {f"{node.module}.{alias.name}" for alias in node.names} | {str(node.module)}
        elif isinstance(node, ast.Constant) and node.value in modules():
            found.add(node.value)
    if path == modules()["app.cli.main"]:  # a command is loaded by the word that a person types
        found |= {module for module in modules() if module.startswith("app.cli.commands.")}
    return frozenset(found)


@cache
def modules() -> dict[str, Path]:
    """The file of every module of the product, entry points left out."""
    found = [path for package in ("algorithms", "app") for path in sorted((ROOT / package).rglob("*.py"))]
    return {
        ".".join(path.relative_to(ROOT).with_suffix("").parts): path
        for path in found
        if path.stem not in ("__init__", "__main__")
    }


@cache
def without_their_own() -> frozenset[str]:
    """Modules that have no test file of their path."""
    return frozenset(
        module
        for module, path in modules().items()
        if not (ROOT / "tests" / path.relative_to(ROOT).parent / f"test_{path.stem}.py").is_file()
    )


def reach(path: Path) -> set[str]:
    """Modules of the product that a test imports, by way of others, too."""
    helpers = {helper.stem: helper for helper in (ROOT / "tests" / "support").glob("*.py")}
    seen: set[str] = set()
    todo = [path, ROOT / "tests" / "conftest.py"]
    while todo:
        for name in imports_of(todo.pop()) - seen:
            seen.add(name)
            if name in modules() or name in helpers:
                todo.append(modules().get(name) or helpers[name])
    return seen & set(modules())


def test_every_module_has_the_test_file_of_its_path_or_stands_in_a_list():
    listed = {module for named in EXERCISED_BY.values() for module in named} | set(BY_NO_TEST)
    without = set(without_their_own())
    assert without - listed == set(), "give each a test file of its path"
    assert listed - without == set(), "take these from the list: they have a file of their own, or are gone"
    assert sum(map(len, EXERCISED_BY.values())) + len(BY_NO_TEST) == len(listed), "once each"


@pytest.mark.parametrize("test", EXERCISED_BY)
def test_a_test_that_is_named_for_a_module_comes_to_it(test):
    path = ROOT / "tests" / test
    assert path.is_file()
    assert EXERCISED_BY[test] - reach(path) == set()
