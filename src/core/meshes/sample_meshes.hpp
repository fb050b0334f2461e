#pragma once

#include "robot_vision/meshes/mesh.hpp"

// The meshes of sampleMesh(), each with what it is by its name.
namespace robot_vision::samples
{

Mesh bottle();
Mesh box();
Mesh bracket();
Mesh can();
Mesh drill();
Mesh duck();
Mesh mug();
Mesh nut();

}  // namespace robot_vision::samples
