// SPDX-License-Identifier: Apache-2.0
#include "tests/fuzz/targets.h"

#include <array>

namespace kerfbench::fuzz {
namespace {

constexpr std::array kTargets{
    Target{"drawing_dxf", drawingDxf, "hil/dieline/read.h"},
    Target{"drawing_svg", drawingSvg, "hil/dieline/read.h"},
    Target{"drawing_pdf", drawingPdf, "hil/dieline/read.h"},
    Target{"drawing_cf2", drawingCf2, "hil/dieline/read.h"},
    Target{"scenario", scenarioFile, "hil/scenario/scenario.h"},
    Target{"machine", machineFile, "hil/machine_file/machine_file.h"},
    Target{"recording_vcd", recordingVcd, "hil/source/vcd.h"},
    Target{"recording_sr", recordingSr, "hil/source/analyser/sr_file.h"},
    Target{"gcode", gcodeText, "firmware_under_test/planner/gcode/gcode.h"},
    Target{"correction_table", correctionTable, "hil/calibrate/tables/table_files.h"},
    Target{"controller_table", controllerTable, "firmware_under_test/planner/head/correction.h"},
    Target{"image_hex", imageHex, "hil/source/emulator/intel_hex.h"},
    Target{"image_elf", imageElf, "hil/source/emulator/elf_segments.h"},
    Target{"image_target", imageTarget, "firmware_under_test/planner/job/target.h"},
    Target{"pin_stream_replies", pinStreamReplies, "hil/source/open.h"},
    Target{"pin_stream_requests", pinStreamRequests, "hil/source/emulator/wire.h"},
    Target{"camera_calibration", cameraCalibration, "hil/calibrate/files/calibration_file.h"},
    Target{"calibration_target", calibrationTarget, "hil/calibrate/files/target_file.h"},
    Target{"scanner_calibration", scannerCalibration, "hil/calibrate/scanner/scanner_file.h"},
    Target{"mark_job", markJob, "hil/calibrate/marks/mark_job_file.h"},
    Target{"tile_list", tileList, "hil/camera/tile_folder.h"},
    Target{"picture", picture, "hil/camera/png.h"},
    Target{"camera_frame", cameraFrame, "hil/camera/v4l2/gray_decode.h"},
    Target{"frame_recording", frameRecording, "hil/camera/v4l2/frame_recording.h"},
    Target{"serial_words", serialWords, "hil/controller/uart_listener.h"},
    Target{"trace_recover", traceRecover, "hil/trace/trace_file.h"},
    Target{"http_head", httpHead, "hil/serve/http_head.h"},
};

}  // namespace

std::span<const Target> targets() { return kTargets; }

}  // namespace kerfbench::fuzz
