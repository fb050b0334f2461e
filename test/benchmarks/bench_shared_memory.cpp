// What images cost between two processes: in slots that both have mapped, and sent through a socket as TCPROS does it.
//
//   bench_shared_memory [FRAMES]

#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <stdexcept>
#include <vector>

#include "measure.hpp"
#include "ros/shared_memory/slot_reader.hpp"
#include "ros/shared_memory/slot_writer.hpp"

using namespace robot_vision;

namespace
{

double now()
{
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double usedCpu()
{
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  const auto seconds = [](const timeval& time) { return static_cast<double>(time.tv_sec) + 1e-6 * time.tv_usec; };
  return seconds(used.ru_utime) + seconds(used.ru_stime);
}

void require(bool done)
{
  if (!done) throw std::runtime_error("a socket ended");
}

void readAll(int socket, void* to, std::size_t bytes)
{
  for (std::size_t got = 0; got < bytes;)
  {
    const ssize_t more = read(socket, static_cast<char*>(to) + got, bytes - got);
    require(more > 0);
    got += static_cast<std::size_t>(more);
  }
}

void writeAll(int socket, const void* from, std::size_t bytes)
{
  for (std::size_t put = 0; put < bytes;)
  {
    const ssize_t more = write(socket, static_cast<const char*>(from) + put, bytes - put);
    require(more > 0);
    put += static_cast<std::size_t>(more);
  }
}

/// What a message says of a frame.
struct Message
{
  double sent = 0.0;
  char socket[64] = "";
  SlotAddress address(std::size_t bytes) const
  {
    return {bootId(), socket, publisher, slot, memory, generation, bytes};
  }
  std::uint64_t publisher = 0;
  std::uint64_t memory = 0;
  std::uint64_t generation = 0;
  std::uint32_t slot = 0;
};

struct Figures
{
  double latency = 0.0;  // s, median
  double cpu = 0.0;      // s for each frame, of the receiving process
};

/// Sends frames by `send` to a forked process that gets them by `receive`, which returns when the frame was sent.
Figures measure(int frames, const std::function<void(int)>& send, const std::function<double(int)>& receive)
{
  constexpr int kWarmUp = 20;
  int sockets[2];
  int results[2];
  if (socketpair(AF_UNIX, SOCK_STREAM, 0, sockets) != 0 || pipe(results) != 0) throw std::runtime_error("no sockets");
  const pid_t child = fork();
  if (child == 0)
  {
    std::vector<double> latencies;
    double cpu = 0.0;
    for (int frame = 0; frame < kWarmUp + frames; ++frame)
    {
      if (frame == kWarmUp) cpu = usedCpu();
      const double sent = receive(sockets[1]);
      if (frame >= kWarmUp) latencies.push_back(now() - sent);
    }
    const Figures figures{bench::median(latencies), (usedCpu() - cpu) / frames};
    writeAll(results[1], &figures, sizeof(figures));
    _exit(0);
  }
  for (int frame = 0; frame < kWarmUp + frames; ++frame)
  {
    send(sockets[0]);
    usleep(5000);  // the receiver waits for each frame, as at the rate of a camera
  }
  Figures figures;
  readAll(results[0], &figures, sizeof(figures));
  waitpid(child, nullptr, 0);
  for (const int number : {sockets[0], sockets[1], results[0], results[1]})
    close(number);
  return figures;
}

Figures bySlots(int frames, std::size_t bytes)
{
  SlotWriter writer;
  SlotReader* reader = nullptr;
  const auto send = [&](int socket)
  {
    const auto slot = writer.take(bytes);
    const SlotAddress address = slot->publish();
    Message message;
    std::snprintf(message.socket, sizeof(message.socket), "%s", address.socket.c_str());
    message.publisher = address.publisher;
    message.memory = address.memory;
    message.generation = address.generation;
    message.slot = address.slot;
    message.sent = now();
    writeAll(socket, &message, sizeof(message));
  };
  const auto receive = [&](int socket)
  {
    if (reader == nullptr) reader = new SlotReader;  // in the process that reads
    Message message;
    readAll(socket, &message, sizeof(message));
    reader->hold(message.address(bytes));
    return message.sent;
  };
  return measure(frames, send, receive);
}

Figures bySocket(int frames, std::size_t bytes)
{
  const std::vector<std::uint8_t> pixels(bytes, 1);
  const auto send = [&](int socket)
  {
    const double sent = now();
    writeAll(socket, &sent, sizeof(sent));
    writeAll(socket, pixels.data(), bytes);
  };
  const auto receive = [&](int socket)
  {
    double sent = 0.0;
    readAll(socket, &sent, sizeof(sent));
    std::vector<std::uint8_t> received(bytes);  // as roscpp: a new message for each
    readAll(socket, received.data(), bytes);
    return sent;
  };
  return measure(frames, send, receive);
}

void measureCalls(std::size_t bytes)
{
  constexpr int kCalls = 200000;
  SlotWriter writer;
  SlotReader reader;
  const double start = now();
  for (std::size_t i = 0; i < SlotWriter::Limits().min_slots; ++i)
    writer.take(bytes)->publish();
  std::printf("new slot of %zu bytes, all of its pages touched: %.2f ms\n", bytes,
              1e3 * (now() - start) / static_cast<double>(SlotWriter::Limits().min_slots));
  const auto address = writer.take(bytes)->publish();
  double used = usedCpu();
  for (int i = 0; i < kCalls; ++i)
    reader.hold(address);
  std::printf("hold and release: %.0f ns\n", 1e9 * (usedCpu() - used) / kCalls);
  used = usedCpu();
  for (int i = 0; i < kCalls; ++i)
    writer.take(bytes)->publish();
  std::printf("take, publish and give back: %.0f ns\n", 1e9 * (usedCpu() - used) / kCalls);
}

}  // namespace

int main(int argc, char** argv)
{
  const int frames = argc > 1 ? std::atoi(argv[1]) : 300;
  measureCalls(1920 * 1080 * 3);
  std::printf("%-12s %22s %22s\n", "", "slots", "socket");
  std::printf("%-12s %10s %11s %10s %11s\n", "size", "p50 us", "CPU us", "p50 us", "CPU us");
  for (const cv::Size size : {cv::Size(640, 480), cv::Size(1920, 1080), cv::Size(3840, 2160)})
  {
    const std::size_t bytes = static_cast<std::size_t>(size.area()) * 3;
    const Figures slots = bySlots(frames, bytes);
    const Figures socket = bySocket(frames, bytes);
    std::printf("%4dx%-7d %10.0f %11.0f %10.0f %11.0f\n", size.width, size.height, 1e6 * slots.latency, 1e6 * slots.cpu,
                1e6 * socket.latency, 1e6 * socket.cpu);
  }
}
