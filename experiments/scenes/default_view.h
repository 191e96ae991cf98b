#pragma once

#include "core/scene/scene.h"

namespace raymeter {

/// Completes the view of a scene from a file: a camera, unless the file had one, and a light where there is none.
///
/// Most mesh files, and glTF by definition, have y up and their front towards +z, so that is assumed for all. The camera looks at the centre of the bounding
/// box from direction (0.5, 0.4, 1), up +y, 45 degrees, from as far away as shows the box's bounding sphere; the light is white and stands behind the viewer at
/// the upper left: from the centre in direction (-1, 2, 2), three diameters of that sphere away.
void complete_view(Scene& scene, bool has_camera);

}  // namespace raymeter
