#include "byte_stream.hpp"
#include "model_head.hpp"
#include "robot_vision/recognition/view_model.hpp"

namespace robot_vision
{
namespace
{

// The head of a model, and then the fields of ViewModel in their order, lists with their length before them.
constexpr std::size_t kFeatureSize = 9;

void writeFeature(const ViewFeature& feature, ByteWriter& to)
{
  to.add(feature.x);
  to.add(feature.y);
  to.add(feature.z);
  to.add(static_cast<std::uint8_t>(feature.kind));
  to.add(feature.a);
  to.add(feature.b);
}

ViewFeature readFeature(ByteReader& from)
{
  ViewFeature feature;
  from.get(feature.x);
  from.get(feature.y);
  from.get(feature.z);
  feature.kind = static_cast<FeatureKind>(from.next<std::uint8_t>());
  from.get(feature.a);
  from.get(feature.b);
  return feature;
}

/// Calls visit(number) for each number of a view, but for its features.
template <class AnyView, class Visit>
void visitView(AnyView& view, const Visit& visit)
{
  visitThree(view.rotation, visit);
  visitThree(view.center, visit);
  visit(view.box.x);
  visit(view.box.y);
  visit(view.box.width);
  visit(view.box.height);
  visit(view.spin);
  visit(view.parent);
}

template <class AnySymmetry, class Visit>
void visitSymmetry(AnySymmetry& symmetry, const Visit& visit)
{
  visitThree(symmetry.axis, visit);
  visit(symmetry.fold);
}

/// Calls visit(number) for each parameter.
template <class Params, class Visit>
void visitParams(Params& params, const Visit& visit)
{
  ViewParams::fields([&](const char* /*name*/, auto member, const auto& /*limits*/, const char* /*unit*/,
                         const char* /*meaning*/) { visit(params.*member); });
}

View readView(ByteReader& from)
{
  View view;
  visitView(view, [&](auto& number) { from.get(number); });
  view.features.reserve(from.count<std::uint16_t>("features", kFeatureSize));
  for (std::size_t i = view.features.capacity(); i > 0; --i)
    view.features.push_back(readFeature(from));
  return view;
}

}  // namespace

std::vector<std::uint8_t> toBytes(const ViewModel& model)
{
  validate(model);
  ByteWriter to;
  const auto add = [&](const auto& number) { to.add(number); };
  writeModelHead(ViewModel::kMethod, to);
  visitParams(model.params, add);
  to.add(static_cast<std::uint32_t>(model.symmetries.size()));
  for (const Symmetry& symmetry : model.symmetries)
    visitSymmetry(symmetry, add);
  visitExtent(model.extent, add);
  to.add(static_cast<std::uint32_t>(model.levels.size()));
  for (const int level : model.levels)
    to.add(level);
  to.add(static_cast<std::uint32_t>(model.views.size()));
  for (const View& view : model.views)
  {
    visitView(view, add);
    to.add(static_cast<std::uint16_t>(view.features.size()));
    for (const ViewFeature& feature : view.features)
      writeFeature(feature, to);
  }
  return to.take();
}

ViewModel viewModelFromBytes(const std::uint8_t* bytes, std::size_t size)
{
  ByteReader from(bytes, size, "a trained model");
  checkModelHead(ViewModel::kMethod, from);
  ViewModel model;
  const auto get = [&](auto& number) { from.get(number); };
  visitParams(model.params, get);
  model.symmetries.resize(from.count<std::uint32_t>("symmetries", 3 * sizeof(double) + sizeof(std::int32_t)));
  for (Symmetry& symmetry : model.symmetries)
    visitSymmetry(symmetry, get);
  visitExtent(model.extent, get);
  model.levels.resize(from.count<std::uint32_t>("levels", sizeof(std::int32_t)));
  for (int& level : model.levels)
    from.get(level);
  const std::size_t count = from.count<std::uint32_t>("views", 11 * sizeof(double) + sizeof(std::int32_t) + 2);
  model.views.reserve(count);
  for (std::size_t i = 0; i < count; ++i)
    model.views.push_back(readView(from));
  from.end();
  validate(model);
  return model;
}

}  // namespace robot_vision
