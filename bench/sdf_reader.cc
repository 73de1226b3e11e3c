// Reads SDF files with Gazebo's own library: every error, every link's pose, masses and springs.
#include <iostream>
#include <sdf/sdf.hh>

int main(int count, char **files) {
  int faulty = 0;
  for (int i = 1; i < count; ++i) {
    sdf::Root root;
    auto errors = root.Load(files[i]);
    const sdf::Model *model = root.Model();
    double mass = 0.0;
    int springs = 0;
    for (uint64_t k = 0; model && k < model->LinkCount(); ++k) {
      const sdf::Link *link = model->LinkByIndex(k);
      mass += link->Inertial().MassMatrix().Mass();
      ignition::math::Pose3d pose;
      auto unresolved = link->SemanticPose().Resolve(pose, "__model__");
      errors.insert(errors.end(), unresolved.begin(), unresolved.end());
    }
    for (uint64_t k = 0; model && k < model->JointCount(); ++k) {
      const sdf::JointAxis *axis = model->JointByIndex(k)->Axis();
      springs += axis && axis->SpringStiffness() > 0.0;
    }
    for (const auto &error : errors) std::cout << files[i] << ": " << error.Message() << "\n";
    if (!model || !errors.empty()) ++faulty;
    std::cout << files[i] << ": " << (model ? model->LinkCount() : 0) << " links, " << springs
              << " springs, " << mass << " kg, " << errors.size() << " errors\n";
  }
  return faulty;
}
