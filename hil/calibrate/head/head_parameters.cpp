// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/head/head_parameters.h"

namespace kerfbench::calibrate {
namespace {

constexpr std::array<HeadParameterText, kHeadParameterCount> kTexts{{
    {"throw", "mm"},
    {"mirror spacing", "mm"},
    {"tilt of the X mirror's axis across its normal", "rad"},
    {"tilt of the X mirror's axis towards its normal", "rad"},
    {"tilt of the X mirror's face", "rad"},
    {"X mirror's face before its axis", "mm"},
    {"zero of the X mirror", "rad"},
    {"scale of the X mirror", ""},
    {"tilt of the Y mirror's axis across its normal", "rad"},
    {"tilt of the Y mirror's axis towards its normal", "rad"},
    {"tilt of the Y mirror's face", "rad"},
    {"Y mirror's face before its axis", "mm"},
    {"zero of the Y mirror", "rad"},
    {"scale of the Y mirror", ""},
    {"beam offset, horizontal", "mm"},
    {"beam offset, vertical", "mm"},
    {"beam tilt, horizontal", "rad"},
    {"beam tilt, vertical", "rad"},
    {"height of the sheet", "mm"},
    {"slope of the sheet along x", "rad"},
    {"slope of the sheet along y", "rad"},
    {"shift of the head along x", "mm"},
    {"shift of the head along y", "mm"},
    {"turn of the head", "rad"},
    {"focal length", ""},
    {"lens k1", "1/rad²"},
    {"lens k2", "1/rad⁴"},
    {"lens decentre along x", "mm"},
    {"lens decentre along y", "mm"},
    {"lens tilt along x", "rad"},
    {"lens tilt along y", "rad"},
    {"lens incidence ratio", ""},
}};

}  // namespace

HeadParameterText textOf(HeadParameter parameter) { return kTexts.at(indexOf(parameter)); }

bool actsOn(HeadParameter parameter, const HeadDesign& design) {
  switch (parameter) {
    case HeadParameter::kThrow:
    case HeadParameter::kMirrorSpacing:
    case HeadParameter::kXSurface:
    case HeadParameter::kYSurface:
    case HeadParameter::kBeamOffsetA:
    case HeadParameter::kBeamOffsetB:
      return !design.lens;
    default:
      return design.lens || parameter < HeadParameter::kFocalLength;
  }
}

HeadVector HeadTolerances::sigmas(const HeadDesign& design) const {
  HeadVector sigmas;
  const double throw_sigma_mm = throw_share * design.throw_mm;
  sigmas << throw_sigma_mm, mirror_spacing_mm,                                                    //
      axis_tilt_rad, axis_tilt_rad, face_tilt_rad, surface_mm, zero_rad, scale_share,             // X mirror
      axis_tilt_rad, axis_tilt_rad, face_tilt_rad, surface_mm, zero_rad, scale_share,             // Y mirror
      beam_offset_mm, beam_offset_mm, beam_tilt_rad, beam_tilt_rad,                               //
      plane_height_mm, plane_slope, plane_slope, plane_shift_mm, plane_shift_mm, plane_turn_rad,  //
      focal_length_share, lens_k1_1_rad2, lens_k2_1_rad4, lens_decentre_mm, lens_decentre_mm, lens_tilt,
      lens_tilt, lens_incidence;
  return sigmas;
}

}  // namespace kerfbench::calibrate
