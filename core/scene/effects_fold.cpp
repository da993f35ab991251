#include "core/scene/effects_fold.h"

#include <algorithm>

#include "core/math/robust.h"

namespace talbot {
namespace {

constexpr unsigned kG = 2, kB = 4;

// Folds one material after the other. `colored`: a mesh with vertex colours wears it, which come
// between factor and texture in the order of products.
class Folder {
  public:
    Folder(const Scene& scene, EffectSet keep) : scene_(scene), keep_(keep) {}

    Material fold(Material m, bool colored) const {
        if (folds(Effect::base_color_texture)) fold_base_color(m, colored);
        if (folds(Effect::metallic_roughness_texture)) fold_metallic_roughness(m);
        if (folds(Effect::normal_map)) fold_normal(m.normal_texture, m.normal_scale);
        if (folds(Effect::emissive_texture)) fold_emission(m);
        if (folds(Effect::specular)) fold_specular(m);
        if (folds(Effect::transmission)) fold_transmission(m);
        if (folds(Effect::diffuse_transmission)) fold_diffuse_transmission(m);
        if (folds(Effect::clearcoat)) fold_clearcoat(m);
        if (folds(Effect::sheen)) fold_sheen(m);
        if (folds(Effect::anisotropy)) fold_anisotropy(m);
        if (folds(Effect::iridescence)) fold_iridescence(m);
        if (folds(Effect::uv_transform)) {
            for (TextureSlot Material::*slot : kTextureSlots) {
                TextureSlot& s = m.*slot;
                const TextureSlot plain;
                if (s.transform_u == plain.transform_u && s.transform_v == plain.transform_v)
                    s.has_transform = false;
            }
        }
        return m;
    }

  private:
    bool folds(Effect effect) const { return !keep_.has(effect); }
    bool constant(const TextureSlot& slot, unsigned channels) const {
        return slot.used() && scene_.texel_range(slot.texture).is_constant(channels);
    }
    Vec4f value(const TextureSlot& slot, TextureEncoding encoding) const {
        return scene_.texel_range(slot.texture).value(encoding);
    }
    float linear(const TextureSlot& slot, int channel) const {
        return value(slot, TextureEncoding::linear)[channel];
    }
    static void drop(TextureSlot& slot) { slot = TextureSlot{}; }

    void fold_channel(float& factor, TextureSlot& slot, int channel) const {
        if (factor == 0) {
            drop(slot);
        } else if (constant(slot, 1u << channel)) {
            factor *= linear(slot, channel);
            drop(slot);
        }
    }
    // The same; but what a volume is, as boundaries see it, must not depend on the texture.
    void fold_volume_channel(Material& m, float Material::*factor, TextureSlot& slot,
                             int channel) const {
        Material folded = m;
        TextureSlot rest = slot;
        fold_channel(folded.*factor, rest, channel);
        if (folded.is_volume() != m.is_volume()) return;
        m.*factor = folded.*factor;
        slot = rest;
    }
    void fold_color(Rgb& factor, TextureSlot& slot) const {
        if (is_black(factor)) {
            drop(slot);
        } else if (constant(slot, kChannelsRgb)) {
            factor *= Rgb(value(slot, TextureEncoding::srgb));
            drop(slot);
        }
    }

    void fold_base_color(Material& m, bool colored) const {
        TextureSlot& slot = m.base_color_texture;
        if (!slot.used()) return;
        const bool alpha = m.alpha_mode != AlphaMode::opaque;
        if (Rgb(m.base_color_factor) == Rgb(0) && (!alpha || m.base_color_factor.w == 0)) {
            drop(slot);
            return;
        }
        if (!constant(slot, alpha ? kChannelsRgba : kChannelsRgb)) return;
        Vec4f texel = value(slot, TextureEncoding::srgb);
        if (!alpha) texel.w = 1;
        if (colored && texel != Vec4f(1)) return;
        m.base_color_factor *= texel;
        drop(slot);
    }

    void fold_metallic_roughness(Material& m) const {
        TextureSlot& slot = m.metallic_roughness_texture;
        if (!slot.used()) return;
        const unsigned channels =
            (m.roughness_factor == 0 ? 0u : kG) | (m.metallic_factor == 0 ? 0u : kB);
        if (!constant(slot, channels)) return;
        if ((channels & kG) != 0) m.roughness_factor *= linear(slot, 1);
        if ((channels & kB) != 0) m.metallic_factor *= linear(slot, 2);
        drop(slot);
    }

    void fold_normal(TextureSlot& slot, float scale) const {
        if (!slot.used()) return;
        const TexelRange& range = scene_.texel_range(slot.texture);
        const auto flat = [&](std::size_t c) {
            return range.least[c] >= 127 && range.most[c] <= 128;
        };
        if (scale == 0 || (flat(0) && flat(1))) drop(slot);
    }

    void fold_emission(Material& m) const {
        TextureSlot& slot = m.emissive_texture;
        if (!m.is_emissive()) {
            drop(slot);
        } else if (constant(slot, kChannelsRgb)) {
            const Rgb radiance = m.emissive_factor * m.emissive_strength;
            if (!is_finite(radiance)) return;
            m.emissive_factor = radiance * Rgb(value(slot, TextureEncoding::srgb));
            m.emissive_strength = 1;
            drop(slot);
        }
    }

    void fold_specular(Material& m) const {
        fold_channel(m.specular_factor, m.specular_texture, 3);
        if (m.specular_factor == 0) drop(m.specular_color_texture);
        fold_color(m.specular_color_factor, m.specular_color_texture);
    }

    void fold_transmission(Material& m) const {
        fold_volume_channel(m, &Material::transmission_factor, m.transmission_texture, 0);
    }

    void fold_diffuse_transmission(Material& m) const {
        fold_volume_channel(m, &Material::diffuse_transmission_factor,
                            m.diffuse_transmission_texture, 3);
        if (m.diffuse_transmission_factor == 0) drop(m.diffuse_transmission_color_texture);
        fold_color(m.diffuse_transmission_color_factor, m.diffuse_transmission_color_texture);
    }

    void fold_clearcoat(Material& m) const {
        fold_channel(m.clearcoat_factor, m.clearcoat_texture, 0);
        fold_channel(m.clearcoat_roughness_factor, m.clearcoat_roughness_texture, 1);
        fold_normal(m.clearcoat_normal_texture, m.clearcoat_normal_scale);
        if (m.clearcoat_factor > 0) return;
        drop(m.clearcoat_roughness_texture);
        drop(m.clearcoat_normal_texture);
    }

    void fold_sheen(Material& m) const {
        fold_color(m.sheen_color_factor, m.sheen_color_texture);
        fold_channel(m.sheen_roughness_factor, m.sheen_roughness_texture, 3);
        if (!m.has_sheen()) drop(m.sheen_roughness_texture);
    }

    // The direction of a texture is no factor; its strength is.
    void fold_anisotropy(Material& m) const {
        if (constant(m.anisotropy_texture, kB) && linear(m.anisotropy_texture, 2) == 0)
            m.anisotropy_strength = 0;
        if (m.anisotropy_strength == 0) drop(m.anisotropy_texture);
    }

    void fold_iridescence(Material& m) const {
        fold_channel(m.iridescence_factor, m.iridescence_texture, 0);
        TextureSlot& slot = m.iridescence_thickness_texture;
        if (m.iridescence_factor == 0) {
            drop(slot);
        } else if (constant(slot, kG)) {
            const float t = linear(slot, 1);
            m.iridescence_thickness_maximum =
                m.iridescence_thickness_minimum +
                t * (m.iridescence_thickness_maximum - m.iridescence_thickness_minimum);
            m.iridescence_thickness_minimum = m.iridescence_thickness_maximum;
            drop(slot);
        }
    }

    const Scene& scene_;
    EffectSet keep_;
};

}  // namespace

std::vector<Material> fold_materials(const Scene& scene, EffectSet keep) {
    std::vector<bool> colored(scene.materials().size(), false);
    for (const Mesh& mesh : scene.geometry().meshes) {
        if (!mesh.colors.empty() && mesh.material < colored.size()) colored[mesh.material] = true;
    }
    const Folder folder(scene, keep);
    std::vector<Material> folded;
    folded.reserve(colored.size());
    bool changed = false;
    for (std::size_t i = 0; i < colored.size(); ++i) {
        folded.push_back(folder.fold(scene.materials()[i], colored[i]));
        changed = changed || !(folded.back() == scene.materials()[i]);
    }
    if (!changed) folded.clear();
    return folded;
}

std::shared_ptr<const Scene> fold_scene(std::shared_ptr<const Scene> scene, EffectSet keep) {
    std::vector<Material> folded = fold_materials(*scene, keep);
    return folded.empty() ? scene : scene->with_materials(std::move(folded));
}

bool asks_alpha(const Scene& scene, const Material& material, const Mesh* mesh,
                const MeshAlpha* alpha, bool exact) {
    if (material.alpha_mode == AlphaMode::opaque) return false;
    const bool colored = mesh && !mesh->colors.empty();
    const bool textured = material.base_color_texture.used();
    const bool varies = colored && std::any_of(mesh->colors.begin(), mesh->colors.end(),
                                               [](const Vec4f& c) { return c.w < 1; });
    if (varies || (textured && colored)) return true;
    if (!exact) return textured || material.base_color_factor.w < 1;
    uint8_t least = 255;
    if (textured) {
        least = scene.texel_range(material.base_color_texture.texture).least[3];
        if (alpha && alpha->slot == material.base_color_texture) least = alpha->whole.least;
    }
    return least < coverage_limits(material).opaque_from;
}

}  // namespace talbot
