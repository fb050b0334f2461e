// Measures how the recognition of objects by their views grows with their number, and with the number of templates of
// one of them; what a trained model takes of the memory, and how long training takes. Prints JSON, in a line.

#include <cstdio>
#include <exception>
#include <utility>

#include "measure.hpp"
#include "recognition_trials.hpp"
#include "robot_vision/recognition/object_matcher.hpp"
#include "robot_vision/recognition/object_recognizer.hpp"
#include "robot_vision/recognition/point_pairs.hpp"
#include "robot_vision/recognition/view_trainer.hpp"

using namespace robot_vision;

namespace
{

constexpr int kFrames = 8;  // besides one that is not counted

double now()
{
  return bench::seconds(CLOCK_THREAD_CPUTIME_ID);
}

/// What was measured with a number of something.
struct Figures
{
  int number = 0;
  double match = 0.0, decide = 0.0;  // ms, medians of a frame
  double train = 0.0;                // s, of all objects
  double memory = 0.0;               // MB, of all models in the matcher
};

/// The samples, and after these the samples in other sizes, each of which is an object of its own.
Mesh objectNumber(int number)
{
  const std::vector<std::string> names = sampleMeshNames();
  const int count = static_cast<int>(names.size());
  Mesh mesh = sampleMesh(names[static_cast<std::size_t>(number % count)]).mesh;
  for (cv::Vec3f& vertex : mesh.vertices)
    vertex *= 1.0F + 0.1F * static_cast<float>(number / count);
  return mesh;
}

Figures measure(int number, const std::vector<Mesh>& meshes, const ViewParams& params,
                const std::vector<ClutteredFrame>& frames)
{
  ObjectMatcher matcher;
  ObjectRecognizer recognizer;
  Figures figures;
  figures.number = number;
  for (const Mesh& mesh : meshes)
  {
    const double begin = now();
    const ViewModel model = trainViews(mesh, params);
    figures.train += now() - begin;
    if (number <= 0) figures.number = static_cast<int>(model.templates());
    figures.memory += static_cast<double>(matcher.memory(matcher.add(model))) * 1e-6;
    recognizer.add(std::make_shared<ObjectShape>(mesh));
  }
  std::vector<double> match, decide;
  for (std::size_t i = 0; i < frames.size(); ++i)
  {
    RecognitionFrame frame(frames[i].camera);
    const double begin = now();
    const std::vector<PoseCandidate> candidates =
        matcher.match(frames[i].bgr, frames[i].depth, "32FC1", frames[i].camera);
    const double matched = now();
    frame.set(frames[i].bgr, frames[i].depth);
    recognizer.recognize(frame, candidates);
    if (i == 0) continue;
    match.push_back((matched - begin) * 1e3);
    decide.push_back((now() - matched) * 1e3);
  }
  figures.match = bench::median(match);
  figures.decide = bench::median(decide);
  return figures;
}

void print(const char* name, const std::vector<Figures>& all)
{
  std::printf("\"%s\": [", name);
  for (std::size_t i = 0; i < all.size(); ++i)
    std::printf("%s{\"number\": %d, \"match_ms\": %.2f, \"decide_ms\": %.2f, \"train\": %.3f, \"memory\": %.2f}",
                i > 0 ? ", " : "", all[i].number, all[i].match, all[i].decide, all[i].train, all[i].memory);
  std::printf("]");
}

}  // namespace

int main()
try
{
  cv::setNumThreads(1);
  const std::vector<trials::Object> objects = trials::objectsOf(trials::samples(), 3);
  std::vector<ClutteredFrame> frames;
  for (int i = 0; i <= kFrames; ++i)
    frames.push_back(objects[static_cast<std::size_t>(i) % objects.size()].scenes->frame(i));
  std::vector<Figures> by_number, by_templates;
  std::vector<Mesh> meshes;
  for (const int number : {1, 5, 15, 50})
  {
    while (static_cast<int>(meshes.size()) < number)
      meshes.push_back(objectNumber(static_cast<int>(meshes.size())));
    by_number.push_back(measure(number, meshes, ViewParams(), frames));
  }
  for (int subdivisions = 0; subdivisions <= 3; ++subdivisions)
  {
    ViewParams params;
    params.subdivisions = subdivisions;
    by_templates.push_back(measure(0, {meshes.front()}, params, frames));
  }
  const double begin = now();
  trainPointPairs(meshes.front());
  const double pairs = now() - begin;
  std::printf("{");
  print("objects", by_number);
  std::printf(", ");
  print("templates", by_templates);
  std::printf(", \"pairs_train\": %.3f}\n", pairs);
  return 0;
}
catch (const std::exception& e)
{
  std::fprintf(stderr, "bench_recognition_growth: %s\n", e.what());
  return 1;
}
