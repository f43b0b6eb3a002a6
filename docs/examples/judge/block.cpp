// Two unknowns, displacement and vertical strain, by the scheme that the scene states; Poisson's ratio 0.
#include <cstdio>
#include <iostream>
#include <map>
#include <sstream>
#include <string>

int main() {
    std::map<std::string, std::string> scene;
    for (std::string line, key, value; std::getline(std::cin, line);) {
        std::istringstream(line) >> key >> value;
        scene[key] = value;
    }
    auto number = [&](const char* key) { return std::stod(scene.count(key) ? scene[key] : "0"); };
    bool other = scene.count("also") || scene["contact.law"] != "locked" || scene["time.scheme"] != "newmark";
    for (auto key : {"block.poisson", "load.eccentricity_m", "load.traction_Pa", "load.gravity_m_per_s2"})
        other = other || number(key) != 0;
    if (other) {
        std::fprintf(stderr, "a block on locked springs under a centred pressure only\n");
        return 77;
    }
    double w = number("block.width_m"), h = number("block.height_m"), p = number("contact.stiffness_N_per_m");
    double m = number("block.density_kg_per_m3") * w * h, q = number("load.pressure_Pa") * w;
    double dt = number("time.step_s"), alpha = number("time.alpha"), delta = number("time.delta"), gg = number("time.gg");
    double M[2] = {m, m * h * h / 12}, F[2] = {-q, -q * h / 2};
    double K[2][2] = {{2 * p, -p * h}, {-p * h, number("block.young_Pa") * w * h + p * h * h / 2}};
    double S[2][2], D[2] = {0, 0}, V[2] = {0, 0}, A[2] = {0, 0};
    for (int i = 0; i < 2; i++) {
        for (int j = 0; j < 2; j++) S[i][j] = (i == j ? M[i] : 0) + alpha * dt * dt * K[i][j];
        if (scene["time.start"] == "consistent") A[i] = F[i] / M[i];
    }
    double det = S[0][0] * S[1][1] - S[0][1] * S[1][0];
    std::printf("time_s,displacement_m,contact_pressure_Pa\n");
    for (int n = 1; n <= number("time.steps"); n++) {
        double ahead[2], r[2];
        for (int i = 0; i < 2; i++) ahead[i] = D[i] + gg * dt * V[i] + dt * dt * (0.5 - alpha) * A[i];
        for (int i = 0; i < 2; i++) r[i] = F[i] - K[i][0] * ahead[0] - K[i][1] * ahead[1];
        double a[2] = {(S[1][1] * r[0] - S[0][1] * r[1]) / det, (S[0][0] * r[1] - S[1][0] * r[0]) / det};
        for (int i = 0; i < 2; i++) {
            V[i] = gg * V[i] + dt * ((1 - delta) * A[i] + delta * a[i]);
            D[i] = ahead[i] + alpha * dt * dt * a[i];
            A[i] = a[i];
        }
        std::printf("%.17g,%.17g,%.17g\n", n * dt, D[0], -2 * p * (D[0] - h / 2 * D[1]) / w);
    }
}
