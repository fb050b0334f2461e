#pragma once

#include <string>

#include "byte_stream.hpp"

namespace robot_vision
{

// The bytes of each trained model begin with a magic, the version of the format, and the name of the method.

void writeModelHead(const std::string& method, ByteWriter& to);

/// Throws std::invalid_argument unless the head is that of a model of this method, which this version can read.
void checkModelHead(const std::string& method, ByteReader& from);

/// Calls visit(number) for each of the three numbers of a vector.
template <class Vector, class Visit>
void visitThree(Vector& vector, const Visit& visit)
{
  for (int i = 0; i < 3; ++i)
    visit(vector[i]);
}

/// Calls visit(number) for each number of a MeshExtent, in the order in which models have them.
template <class Extent, class Visit>
void visitExtent(Extent& extent, const Visit& visit)
{
  visitThree(extent.center, visit);
  visitThree(extent.size, visit);
  visit(extent.diameter);
  visit(extent.radius);
}

}  // namespace robot_vision
