#include "core/scene/texture_kernels.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "core/scene/scene_canvas.hpp"
#include "core/scene/scene_renderer.hpp"
#include "support/images.hpp"
#include "support/plain_texture.hpp"

using namespace robot_vision;
using scene::TextureKernels;
using scene::TexturePlane;

namespace
{

enum class Alpha
{
  kOpaque,
  kAny,
  kOnlyLimits,  // 0 and 255
};

/// Random texels with a transparent border.
std::vector<std::uint32_t> texelsOf(int width, int height, Alpha alpha, std::mt19937& random)
{
  std::vector<std::uint32_t> texels;
  for (int y = 0; y < height + 2; ++y)
    for (int x = 0; x < width + 2; ++x)
    {
      const bool border = x == 0 || y == 0 || x > width || y > height;
      const std::uint32_t any = alpha == Alpha::kAny ? random() % 256 : (random() % 2) * 255;
      const std::uint32_t of_this = border ? 0 : alpha == Alpha::kOpaque ? 255 : any;
      texels.push_back(of_this << 24 | random() % (1 << 24));
    }
  return texels;
}

/// Rays along a row of an image of two units' width, some of them beside the texture.
struct Rays
{
  explicit Rays(int count, float y) : xs(static_cast<std::size_t>(count)), ys(xs.size(), y)
  {
    for (int i = 0; i < count; ++i)
      xs[static_cast<std::size_t>(i)] = 2.0F * static_cast<float>(i) / static_cast<float>(count) - 1.0F;
  }

  std::vector<float> xs, ys;
};

/// The pixels after a run was drawn over some that are there, with as many behind it as one group of a kernel has.
template <class Draw>
std::vector<std::uint8_t> drawn(const Draw& draw, const TexturePlane& view, const Rays& rays)
{
  std::vector<std::uint8_t> pixels(3 * (rays.xs.size() + 16));
  for (std::size_t i = 0; i < pixels.size(); ++i)
    pixels[i] = static_cast<std::uint8_t>(37 * i);
  draw(view, rays.xs.data(), rays.ys.data(), static_cast<int>(rays.xs.size()), pixels.data());
  return pixels;
}

/// Maps the middle of the view to that of the texture, turned and seen at an angle.
TexturePlane viewOf(const std::vector<std::uint32_t>& texels, int width, int height, float size)
{
  return {texels.data(), width, height, {size, 0.3F, 0.5F, -0.2F, size, 0.5F, 0.1F, -0.07F, 1.0F}};
}

void expectSame(const TexturePlane& view, const Rays& rays)
{
  const auto plain = drawn(drawPlainly, view, rays), ours = drawn(kernels<TextureKernels>().draw, view, rays);
  ASSERT_EQ(plain, ours) << view.width << "x" << view.height << ", " << rays.xs.size() << " pixels";
}

}  // namespace

TEST(TextureKernels, drawWhatAPlainLoopDraws)
{
  std::mt19937 random(1);
  for (const Alpha alpha : {Alpha::kOpaque, Alpha::kAny, Alpha::kOnlyLimits})
    for (const int width : {1, 2, 7, 64, 500})
    {
      const int height = width / 2 + 1;
      const auto texels = texelsOf(width, height, alpha, random);
      for (int count = 1; count <= TextureKernels::kMaxRun; ++count)
        for (const float size : {0.3F, 0.55F, 2.0F})
          for (const float y : {-0.9F, 0.03F, 0.4F})
            expectSame(viewOf(texels, width, height, size), Rays(count, y));
    }
}

TEST(TextureKernels, drawTheirTexelsWhereRaysMeetTheirMiddles)
{
  const int count = 8;
  std::mt19937 random(2);
  const auto texels = texelsOf(count, 1, Alpha::kOpaque, random);
  Rays rays(count, 0.0F);
  for (int i = 0; i < count; ++i)
    rays.xs[static_cast<std::size_t>(i)] = (static_cast<float>(i) + 0.5F) / count;
  const TexturePlane view = {texels.data(), count, 1, {1, 0, 0, 0, 0, 0.5F, 0, 0, 1}};
  const auto pixels = drawn(kernels<TextureKernels>().draw, view, rays);
  for (int i = 0; i < count; ++i)
    for (int k = 0; k < 3; ++k)
      EXPECT_EQ(pixels[static_cast<std::size_t>(3 * i + k)],
                texels[static_cast<std::size_t>(count + 3 + i)] >> (8 * k) & 255);
}

TEST(TextureKernels, leaveWhatIsBesideTheTexture)
{
  std::mt19937 random(3);
  const auto texels = texelsOf(4, 4, Alpha::kOpaque, random);
  const Rays rays(TextureKernels::kMaxRun, 0.0F);
  const TexturePlane above = {texels.data(), 4, 4, {1, 0, 0.5F, 0, 1, -3.0F, 0, 0, 1}};
  const auto nothing = [](const TexturePlane&, const float*, const float*, int, std::uint8_t*) {};
  EXPECT_EQ(drawn(kernels<TextureKernels>().draw, above, rays), drawn(nothing, above, rays));
}

TEST(TextureKernels, drawTheRoomAsAPlainLoopDoes)
{
  const scene::SceneRenderer room;
  const scene::Lens lens(scene::sceneCamera(203, 151));
  for (const double seconds : {0.0, 4.5, 11.0, 16.0})
  {
    const cv::Affine3d world = scene::cameraPose(seconds).inv();
    cv::Mat plain(lens.camera.height, lens.camera.width, CV_8UC3), ours = plain.clone();
    scene::ColorCanvas plain_canvas(lens, plain, drawPlainly), canvas(lens, ours);
    room.draw(seconds, world, plain_canvas);
    room.draw(seconds, world, canvas);
    EXPECT_TRUE(equal(plain, ours)) << seconds;
  }
}
