// SPDX-License-Identifier: Apache-2.0
// Checker plate: steps of steel with raised lenses, which shade and light each other. The first command draws the lenses as
// a normal map, the second has them on the steps; with Declare=Alone=1 each shines alone.
//
//   build/povray/povray +Iexamples/povray/cookbook/checker_plate.pov +Obuild/lenses.png +W256 +H256 +FN16 File_Gamma=1 Declare=Map=1
//   build/povray/povray +Iexamples/povray/cookbook/checker_plate.pov +Lbuild +Obuild/checker_plate.png +W640 +H360 +A0.1 +AM2 +R2
#version 3.7;
#declare mdf_Defaults = 1;
#ifndef (mdf_Version) #error "This scene needs POV-Ray with libshade." #end
global_settings { assumed_gamma 1 }

#ifdef (Map)

// One tile of the plate from 0 to 1, which repeats. Two lenses lie one way, two the other, and all else is flat.
#declare Lens = function(A, B) { .03*pow(max(0, 1 - pow(A/.2, 2) - pow(B/.065, 2)), 1.5) }
#declare Leaning = function(X, Y) { Lens((X + Y)/sqrt(2), (X - Y)/sqrt(2)) }
#declare Height = function(X, Y) {
  Leaning(X - .25, Y - .25) + Leaning(X - .75, Y - .75) + Leaning(.75 - X, Y - .25) + Leaning(.25 - X, Y - .75)
}
#declare E = 1/512;
#declare DX = function(X, Y) { (Height(X + E, Y) - Height(X - E, Y))/(2*E) }
#declare DY = function(X, Y) { (Height(X, Y + E) - Height(X, Y - E))/(2*E) }
#declare Long = function(X, Y) { sqrt(1 + pow(DX(X, Y), 2) + pow(DY(X, Y), 2)) }

camera { orthographic location <.5, .5, -1> right x up y direction z }
plane {
  z, 0
  pigment { // each colour is a part of the normal, from -1 to 1
    average pigment_map {
      [1 function { .5 - .5*DX(x, y)/Long(x, y) } color_map { [0 rgb 0] [1 rgb 3*x] }]
      [1 function { .5 - .5*DY(x, y)/Long(x, y) } color_map { [0 rgb 0] [1 rgb 3*y] }]
      [1 function { .5 + .5/Long(x, y) } color_map { [0 rgb 0] [1 rgb 3*z] }]
    }
  }
  finish { ambient 0 diffuse 0 emission 1 }
}

#else

camera { location <-2.3, 2.7, -4.4> right 16/9*x up y angle 36 look_at <-.05, .62, .5> }
light_source { <6, 7, 3>, rgb .7 area_light 2*x, 2*z, 3, 3 adaptive 1 }
sky_sphere { pigment { gradient y color_map { [0 rgb .1] [.5 rgb <.3, .33, .38>] [1 rgb <.7, .75, .85>] } scale 2 translate -y } }
box { <-4, 2.5, 5>, <3, 5, 5.1> pigment { rgb 2.4 } finish { ambient 0 diffuse 0 emission 1 } }
plane { y, 0 pigment { rgb <.2, .19, .18> } finish { ambient .1 diffuse .6 } }

#declare Plate = texture {
  pigment { rgb 0 }
  finish {
    ambient 0 diffuse 0
    mdf {
      ggx .18, .18 specular rgb <.56, .57, .58> fresnel schlick
      bump_image { png "lenses.png" scale 1/2 }
      #ifndef (Alone) horizon mutual #end
      reflection { samples 16 clamp 8 }
    }
  }
}

// One unit of u and v each unit long
#macro Half(A, B, C) triangle { A, B, C uv_vectors <A.x, A.z>, <B.x, B.z>, <C.x, C.z> } #end

mesh {
  #for (Step, 0, 3)
    #local A = <-1.6, .4*Step + .3, .8*Step>;
    Half(A, A + 3.2*x, A + 3.2*x + .8*z)
    Half(A, A + 3.2*x + .8*z, A + .8*z)
  #end
  texture { Plate }
}
union {
  #for (Step, 0, 3) box { <-1.6, 0, .8*Step>, <1.6, .4*Step + .299, .8*Step + .8> } #end
  pigment { rgb <.75, .5, .05> }
  finish { ambient .1 diffuse .6 }
}

#end
