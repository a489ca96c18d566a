// Files of class weights.
#include "dkp_slam/detection/class_table.h"
#include "fuzz/target.h"

namespace dkp_slam::fuzz {
namespace {

void run(Bytes bytes) {
  const InputFile file(bytes);
  takes([&] {
    const ClassTable table = ClassTable::load(file.path());
    for (int id = 0; id < ClassTable::class_count; ++id) {
      require(table.weight(id) >= 1.0F && table.weight(id) <= 10.0F, "a weight out of bounds");
      require(ClassTable::find(ClassTable::name(id)) == id, "a name that is another class's");
    }
  });
}

std::vector<std::string> seeds() {
  return {"weights:\n  person: 10\n  chair: 4.5\n", "weights: {cat: 1, dog: .inf}\n",
          "weights: &w {cup: 2}\nother: *w\n"};
}

const Registration registration({"classes", run, seeds});

}  // namespace
}  // namespace dkp_slam::fuzz
