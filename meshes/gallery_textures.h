#pragma once

#include "lambake/scene/picture.h"

/// The gallery's textures, computed: the same pixels on every run. They tile, but for the painting.
namespace lambake {

/// Floor boards with grain, 2.5 m wide.
Picture wood_planks();

/// Pale stone with dark veins.
Picture marble_veins();

/// A sun over hills in bands of colour.
Picture dusk_painting();

}  // namespace lambake
