// SPDX-License-Identifier: Apache-2.0
#include "hil/scene/pov_materials.h"

namespace kerfbench::scene {

// Glass has no refraction: it would only blur what stands behind it. Beam and glass
// throw no shadow; they stand in light groups without lamps (pov_text.cpp), since asking every lamp about
// every pane costs most of the time and shows nothing.
const char* const kPovMaterials = R"(#version 3.7;
global_settings { assumed_gamma 1.0 max_trace_level 24 adc_bailout 0.008 }
background { rgb <0.40,0.42,0.45> }
#default { finish { ambient 0.05 diffuse 0.8 } }
#macro RoundBox(H, R)
union {
  box { <-H.x,-H.y+R,-H.z+R>, <H.x,H.y-R,H.z-R> }
  box { <-H.x+R,-H.y,-H.z+R>, <H.x-R,H.y,H.z-R> }
  box { <-H.x+R,-H.y+R,-H.z>, <H.x-R,H.y-R,H.z> }
  #local I = -1;
  #while (I <= 1)
    #local J = -1;
    #while (J <= 1)
      cylinder { <I*(H.x-R),J*(H.y-R),-H.z+R>, <I*(H.x-R),J*(H.y-R),H.z-R>, R }
      cylinder { <I*(H.x-R),-H.y+R,J*(H.z-R)>, <I*(H.x-R),H.y-R,J*(H.z-R)>, R }
      cylinder { <-H.x+R,I*(H.y-R),J*(H.z-R)>, <H.x-R,I*(H.y-R),J*(H.z-R)>, R }
      sphere { <I*(H.x-R),J*(H.y-R),H.z-R>, R }
      sphere { <I*(H.x-R),J*(H.y-R),-H.z+R>, R }
      #local J = J + 2;
    #end
    #local I = I + 2;
  #end
}
#end
#declare T_Steel = texture { pigment { rgb <0.42,0.43,0.45> }
  finish { ambient 0.02 diffuse 0.42 specular 0.65 roughness 0.02 metallic reflection { 0.26 metallic } } }
#declare T_Aluminium = texture { pigment { rgb <0.46,0.48,0.50> }
  finish { ambient 0.03 diffuse 0.62 specular 0.25 roughness 0.06 metallic } }
#declare T_Paint = texture { pigment { rgb <0.030,0.085,0.17> }
  finish { ambient 0.03 diffuse 0.8 specular 0.22 roughness 0.03 } }
#declare T_Dark = texture { pigment { rgb <0.030,0.032,0.037> }
  finish { ambient 0.06 diffuse 0.8 specular 0.20 roughness 0.03 } }
#declare T_Belt = texture { pigment { rgb <0.022,0.034,0.032> } finish { ambient 0.04 diffuse 0.8 specular 0.04 roughness 0.1 } }
#declare T_BeltHole = texture { pigment { rgb <0.004,0.005,0.005> } finish { ambient 0 diffuse 0.6 } }
#declare T_Board = texture { pigment { rgb <0.80,0.77,0.70> } finish { ambient 0.05 diffuse 0.72 } }
#declare T_Print = texture { pigment { rgb <0.008,0.008,0.012> } finish { ambient 0.03 diffuse 0.6 } }
#declare T_Mirror = texture { pigment { rgb <0.95,0.74,0.34> }
  finish { ambient 0.02 diffuse 0.22 specular 0.9 roughness 0.004 metallic reflection { 0.66 metallic } } }
#declare T_Glass = texture { pigment { rgbt <0.55,0.78,0.85,0.90> } finish { ambient 0 diffuse 0 emission 0.35 reflection { 0.015, 0.25 } } }
#declare T_Tube = texture { pigment { rgbt <0.75,0.85,0.92,0.74> } finish { ambient 0 diffuse 0 emission 0.5 reflection { 0.03, 0.35 } } }
#declare T_Bore = texture { pigment { rgb <0.55,0.58,0.62> } finish { ambient 0.1 diffuse 0.7 } }
#declare T_Discharge = texture { pigment { rgb <1.0,0.28,0.50> } finish { ambient 0 diffuse 0.2 emission 0.8 } }
#declare T_Burnt = texture { pigment { rgb <0.030,0.012,0.005> } finish { ambient 0.02 diffuse 0.5 } }
#declare T_BeamOff = texture { pigment { rgbt <0.60,0.03,0.02,0.45> } finish { ambient 0 diffuse 0 emission 0.8 } }
#declare P_Clear = pigment { rgbt <1,0.1,0.02,1> }
#declare T_BeamCore = texture {
  pigment { aoi pigment_map { [0.52 P_Clear] [0.75 rgbt <1.0,0.16,0.02,0.25>] [1.0 rgbt <1.0,0.32,0.06,0.0>] } }
  finish { ambient 0 diffuse 0 emission 1.5 } }
#declare T_BeamGlow = texture {
  pigment { aoi pigment_map { [0.52 P_Clear] [0.80 rgbt <1.0,0.06,0.01,0.93>] [1.0 rgbt <1.0,0.08,0.01,0.62>] } }
  finish { ambient 0 diffuse 0 emission 1.1 } }
#declare T_Spot = texture { pigment { rgb <1.0,0.50,0.14> } finish { ambient 0 diffuse 0 emission 1.8 } }
)";

const char* materialName(twin::Material material) {
  switch (material) {
    case twin::Material::kSteel:
      return "texture { T_Steel }";
    case twin::Material::kAluminium:
      return "texture { T_Aluminium }";
    case twin::Material::kPaint:
      return "texture { T_Paint }";
    case twin::Material::kDark:
      return "texture { T_Dark }";
    case twin::Material::kBelt:
      return "texture { T_Belt }";
    case twin::Material::kBeltHole:
      return "texture { T_BeltHole }";
    case twin::Material::kBoard:
      return "texture { T_Board }";
    case twin::Material::kPrint:
      return "texture { T_Print }";
    case twin::Material::kMirror:
      return "texture { T_Mirror }";
    case twin::Material::kGlass:
      return "texture { T_Glass } no_shadow";
    case twin::Material::kTube:
      return "texture { T_Tube } no_shadow";
    case twin::Material::kAxisX:
      return "pigment { rgb <0.70,0.02,0.02> } finish { ambient 0.25 diffuse 0.6 }";
    case twin::Material::kAxisY:
      return "pigment { rgb <0.01,0.36,0.03> } finish { ambient 0.25 diffuse 0.6 }";
    case twin::Material::kAxisZ:
      return "pigment { rgb <0.02,0.07,0.70> } finish { ambient 0.25 diffuse 0.6 }";
    case twin::Material::kLight:
      break;
  }
  return "pigment { rgb 0.92 } finish { ambient 0.1 diffuse 0.8 }";
}

}  // namespace kerfbench::scene
