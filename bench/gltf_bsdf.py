"""glTF's surface as a BSDF of Mitsuba 3 (Dr.Jit variants), an oracle for Talbot's: written from the specification, the
extensions' texts and the papers that docs/materials.md names, with albedos by quadrature in numpy (gltf_albedo.py).

Register with register(); a BSDF is then {"type": "gltf", "index": add(material, textures)}. Not known: transmission (use
Mitsuba's own dielectrics with {"type": "attenuated"}), normal maps, a coat's own normal, films on glass.
"""
import drjit as dr
import mitsuba as mi
import numpy as np

import gltf_albedo as quadrature

NODES = quadrature.NODES
ALPHAS = 33  # of textured roughness, sqrt(alpha) in equal steps
LEAST_ALPHA = 1e-3
materials = []


def add(material, textures):
    """A glTF material and its textures by slot, as Mitsuba textures' dictionaries; returns the index for the plugin."""
    materials.append((material, textures))
    return len(materials) - 1


def extension(material, name):
    return material.get("extensions", {}).get(name, {})


class Table:
    """Rows of values at quadrature.cosines(), by row in [0, rows - 1]; linear between nodes."""

    def __init__(self, values):
        values = np.atleast_2d(np.asarray(values, float))
        self.rows = values.shape[0]
        self.data = mi.Float(values.astype(np.float32).ravel())

    def __call__(self, mu, row=0.0, active=True):
        x = dr.sqrt(dr.clip(mu, 0, 1)) * (NODES - 1)
        i = mi.UInt32(dr.minimum(dr.floor(x), NODES - 2))
        s = x - mi.Float(i)
        if self.rows == 1:
            return dr.lerp(dr.gather(mi.Float, self.data, i, active), dr.gather(mi.Float, self.data, i + 1, active), s)
        y = dr.clip(row, 0, self.rows - 1)
        j = mi.UInt32(dr.minimum(dr.floor(y), self.rows - 2))
        t = y - mi.Float(j)

        def at(k):
            return dr.gather(mi.Float, self.data, k, active)

        k = j * NODES + i
        return dr.lerp(dr.lerp(at(k), at(k + 1), s), dr.lerp(at(k + NODES), at(k + NODES + 1), s), t)


class GltfBsdf(mi.BSDF):
    def __init__(self, props):
        mi.BSDF.__init__(self, props)
        material, textures = materials[props["index"]]
        pbr = material.get("pbrMetallicRoughness", {})
        self.textures = {slot: mi.load_dict(t) for slot, t in textures.items()}
        color = pbr.get("baseColorFactor", [1, 1, 1, 1])[:3]
        self.color = mi.Color3f(color)
        self.metallic, self.roughness = pbr.get("metallicFactor", 1), pbr.get("roughnessFactor", 1)
        ior = extension(material, "KHR_materials_ior").get("ior", 1.5)
        specular = extension(material, "KHR_materials_specular")
        tint = np.array(specular.get("specularColorFactor", [1, 1, 1]), float)
        self.f90 = specular.get("specularFactor", 1)
        f0 = np.minimum(((ior - 1) / (ior + 1)) ** 2 * tint, 1) * self.f90
        self.f0, self.largest_f0 = mi.Color3f(f0), float(f0.max())
        self.textured = "metallicRoughness" in self.textures
        self.anisotropy = extension(material, "KHR_materials_anisotropy")
        self.film = extension(material, "KHR_materials_iridescence")
        coat, sheen = extension(material, "KHR_materials_clearcoat"), extension(material, "KHR_materials_sheen")
        self.coat, self.coat_alpha = coat.get("clearcoatFactor", 0), max(coat.get("clearcoatRoughnessFactor", 0) ** 2, LEAST_ALPHA)
        self.sheen = mi.Color3f(sheen.get("sheenColorFactor", [0, 0, 0]))
        self.largest_sheen = max(sheen.get("sheenColorFactor", [0, 0, 0]))
        self.sheen_alpha = sheen.get("sheenRoughnessFactor", 0) ** 2
        self.lambert = self.metallic == 0 and self.f90 == 0 and not (self.coat or self.largest_sheen or self.film)
        self.m_flags = mi.BSDFFlags.DiffuseReflection | mi.BSDFFlags.GlossyReflection | mi.BSDFFlags.FrontSide | mi.BSDFFlags.BackSide
        self.m_components = [self.m_flags]
        if not self.lambert:
            self.make_tables(f0, np.array(color))
        # Of samples: coat, specular, the rest is diffuse (sheen is found by it).
        self.p_coat = 0.3 if self.coat else 0.0
        p_specular = 0.0 if self.lambert else 0.5 + 0.45 * (0 if self.textured else self.metallic)
        self.p_specular = (1 - self.p_coat) * (p_specular - (0.3 if self.largest_sheen else 0))

    def make_tables(self, f0, color):
        alpha = max(self.roughness ** 2, LEAST_ALPHA)
        self.ax = self.ay = alpha
        if self.textured:
            alphas = np.maximum(np.linspace(0, 1, ALPHAS) ** 2, LEAST_ALPHA)
            a, b = (np.array(v) for v in zip(*(quadrature.schlick_split(x, n=32) for x in alphas)))
        elif self.anisotropy:
            self.ax = alpha + (1 - alpha) * self.anisotropy.get("anisotropyStrength", 0) ** 2
            self.around = np.linspace(0, np.pi / 2, 17)
            a, b = (v.T for v in quadrature.schlick_split(self.ax, self.ay, self.around))
        else:
            a, b = quadrature.schlick_split(alpha, n=64)
        self.a, self.b = Table(a), Table(b)
        # The dielectric with what Turquin 2019 gives back, in its largest channel, and its mean over the hemisphere.
        rows = np.atleast_2d((self.largest_f0 * a + self.f90 * b) * (1 + self.largest_f0 * (1 - a - b) / (a + b)))
        if self.anisotropy:
            rows = rows.mean(0, keepdims=True)
        if self.film:
            ior, thick = self.film.get("iridescenceIor", 1.3), self.film.get("iridescenceThicknessMaximum", 400)
            factor = self.film.get("iridescenceFactor", 0)

            def under_film(base, f90):
                def fresnel(mu):
                    plain = base + (f90 - base) * ((1 - mu) ** 5)[..., None]
                    return plain + factor * (quadrature.film_reflectance(mu, ior, thick, base) - plain)
                return fresnel

            def mixed(mu):
                return (1 - self.metallic) * under_film(f0, self.f90)(mu) + self.metallic * under_film(color, 1)(mu)

            self.fresnel = [Table(mixed(quadrature.cosines())[:, k]) for k in range(3)]
            largest = under_film(f0, self.f90)
            lost = (1 - a - b) / (a + b)
            single = quadrature.reflectance_albedo(alpha, lambda mu: largest(mu).max(-1, keepdims=True), 64)[:, 0]
            rows = np.minimum(single * (1 + largest(quadrature.cosines()).max(-1) * lost), 1)[None]
        self.s = Table(rows)
        self.mean_s = mi.Float([quadrature.hemisphere_mean(r) for r in rows])
        if self.coat:
            a, b = quadrature.schlick_split(self.coat_alpha, n=64)
            self.coat_scale = Table(self.coat * (1 + 0.04 * (1 - a - b) / (a + b)))
            self.coat_albedo = Table(self.coat * (0.04 * a + b) * (1 + 0.04 * (1 - a - b) / (a + b)))
        if self.largest_sheen:
            e = quadrature.charlie_albedo(self.sheen_alpha)
            self.sheen_albedo, self.sheen_scale = Table(np.minimum(e, 1)), Table(1 / np.maximum(e, 1))

    # The surface at a point: base colour, metal, widths of the distribution.
    def surface(self, si, active):
        color, metallic, roughness = self.color, mi.Float(self.metallic), mi.Float(self.roughness)
        if "baseColor" in self.textures:
            color = color * self.textures["baseColor"].eval(si, active)
        if self.textured:
            both = self.textures["metallicRoughness"].eval_3(si, active)
            metallic, roughness = metallic * both.z, roughness * both.y
            alpha = dr.maximum(roughness * roughness, LEAST_ALPHA)
            return color, metallic, alpha, alpha, roughness * (ALPHAS - 1)
        if self.lambert:
            return color, metallic, mi.Float(1), mi.Float(1), mi.Float(0)
        return color, metallic, mi.Float(self.ax), mi.Float(self.ay), mi.Float(0)

    # Directions in the frame of the anisotropy, on wi's side.
    def turned(self, w, flip):
        w = mi.Vector3f(w.x, w.y, dr.mulsign(w.z, flip))
        angle = self.anisotropy.get("anisotropyRotation", 0)
        if angle:
            c, s = float(np.cos(angle)), float(np.sin(angle))
            w = mi.Vector3f(c * w.x + s * w.y, c * w.y - s * w.x, w.z)
        return w

    def turned_back(self, w, flip):
        angle = self.anisotropy.get("anisotropyRotation", 0)
        if angle:
            c, s = float(np.cos(angle)), float(np.sin(angle))
            w = mi.Vector3f(c * w.x - s * w.y, c * w.y + s * w.x, w.z)
        return mi.Vector3f(w.x, w.y, dr.mulsign(w.z, flip))

    @staticmethod
    def slant(ax, ay, w):
        return dr.sqrt(dr.square(ax * w.x) + dr.square(ay * w.y) + dr.square(w.z))

    def lobe(self, ax, ay, o, i):
        """(D G2 / (4 cos_o), cos_d, density of visible normals' reflections)."""
        h = dr.normalize(o + i)
        cos_d = dr.clip(dr.dot(h, o), 0, 1)
        d = dr.inv_pi / (ax * ay * dr.square(dr.square(h.x / ax) + dr.square(h.y / ay) + dr.square(h.z)))
        slant_o, slant_i = self.slant(ax, ay, o), self.slant(ax, ay, i)
        value = d * 0.5 * i.z / dr.maximum(i.z * slant_o + o.z * slant_i, 1e-20)
        return value, cos_d, d * 0.5 / dr.maximum(o.z + slant_o, 1e-20)

    def lobe_sample(self, ax, ay, o, u):
        v = dr.normalize(mi.Vector3f(ax * o.x, ay * o.y, o.z))
        phi = dr.two_pi * u.x
        z = dr.fma(1 - u.y, 1 + v.z, -v.z)  # Dupuy and Benyoub 2023: a spherical cap
        s = dr.safe_sqrt(1 - z * z)
        c = mi.Vector3f(s * dr.cos(phi), s * dr.sin(phi), z) + v
        h = dr.normalize(mi.Vector3f(ax * c.x, ay * c.y, c.z))
        return 2 * dr.dot(o, h) * h - o

    def around_row(self, o):
        """Row of the anisotropic table."""
        return dr.atan2(dr.abs(o.y), dr.abs(o.x)) / (0.5 * dr.pi) * 16

    def both(self, si, wo, active):
        """Value times cosine and density."""
        flip = mi.Float(si.wi.z)
        o, i = self.turned(si.wi, flip), self.turned(wo, flip)
        active = active & (o.z > 0) & (i.z > 0)
        o.z = dr.maximum(o.z, 1e-4)
        color, metallic, ax, ay, row = self.surface(si, active)
        pdf_diffuse = i.z * dr.inv_pi
        if self.lambert:
            return dr.select(active, color * pdf_diffuse, 0), dr.select(active, pdf_diffuse, 0)
        own, cos_d, pdf_specular = self.lobe(ax, ay, o, i)
        albedo_row = self.around_row(o) if self.anisotropy else row
        e = self.a(o.z, albedo_row, active) + self.b(o.z, albedo_row, active)
        lost = (1 - e) / e
        grazing = dr.power(1 - cos_d, 5)

        def schlick(f0, f90):
            return (f0 + (f90 - f0) * grazing) * (1 + f0 * lost)

        if self.film:
            at_facet = mi.Color3f(*[t(cos_d, 0, active) for t in self.fresnel])
            at_normal = mi.Color3f(*[t(o.z, 0, active) for t in self.fresnel])
            specular = at_facet * (1 + lost * at_normal)
        else:
            specular = (1 - metallic) * schlick(self.f0, self.f90) + metallic * schlick(color, 1)
        enters, leaves = 1 - self.s(o.z, row, active), 1 - self.s(i.z, row, active)
        mean = self.mean_s
        if self.textured:
            k = mi.UInt32(dr.clip(row, 0, ALPHAS - 2))
            mean = dr.lerp(dr.gather(mi.Float, self.mean_s, k, active), dr.gather(mi.Float, self.mean_s, k + 1, active), row - mi.Float(k))
        value = own * specular + ((1 - metallic) * enters * leaves / (1 - mean) * pdf_diffuse) * color
        pdf = self.p_specular * pdf_specular + (1 - self.p_specular - self.p_coat) * pdf_diffuse
        if self.largest_sheen:
            h = dr.normalize(o + i)
            sin2 = dr.clip(dr.square(h.x) + dr.square(h.y), 0, 1)
            k = self.sheen_alpha
            d = (2 + 1 / k) * dr.power(sin2, 0.5 / k) * (0.5 * dr.inv_pi)
            fibres = d / ((1 + self.charlie_lambda(o.z) + self.charlie_lambda(i.z)) * 4 * o.z) * self.sheen_scale(o.z, 0, active)
            value = fibres * self.sheen + (1 - self.largest_sheen * self.sheen_albedo(o.z, 0, active)) * value
        if self.coat:
            k = mi.Float(self.coat_alpha)
            own, cos_d, pdf_coat = self.lobe(k, k, o, i)
            fresnel = 0.04 + 0.96 * dr.power(1 - cos_d, 5)
            value = own * fresnel * self.coat_scale(o.z, 0, active) + (1 - self.coat_albedo(o.z, 0, active)) * value
            pdf += self.p_coat * pdf_coat
        return dr.select(active, value, 0), dr.select(active, pdf, 0)

    def charlie_lambda(self, mu):
        t = (1 - self.sheen_alpha) ** 2
        rough, sharp = [21.5473, 3.82987, 0.19823, -1.97760, -4.32054], [25.3245, 3.32435, 0.16801, -1.27393, -4.85967]
        a, b, c, d, e = (float(r + t * (s - r)) for r, s in zip(rough, sharp))

        def exponent(x):
            return a / (1 + b * dr.power(x, c)) + d * x + e

        half = float(a / (1 + b * 0.5 ** c) + d * 0.5 + e)
        return dr.select(mu < 0.5, dr.exp(exponent(mu)), dr.exp(2 * half - exponent(dr.maximum(1 - mu, 0))))

    def sample(self, ctx, si, sample1, sample2, active=True):
        flip = mi.Float(si.wi.z)
        wo = mi.warp.square_to_cosine_hemisphere(sample2)
        if not self.lambert:
            o = self.turned(si.wi, flip)
            _, _, ax, ay, _ = self.surface(si, active)
            wo = dr.select(sample1 < self.p_specular, self.lobe_sample(ax, ay, o, sample2), wo)
            if self.coat:
                k = mi.Float(self.coat_alpha)
                wo = dr.select(sample1 >= 1 - self.p_coat, self.lobe_sample(k, k, o, sample2), wo)
        wo = self.turned_back(wo, flip)
        value, pdf = self.both(si, wo, active)
        bs = mi.BSDFSample3f(wo)
        bs.pdf = pdf
        bs.eta = 1.0
        bs.sampled_type = mi.UInt32(+self.m_flags)
        bs.sampled_component = 0
        return bs, dr.select(active & (pdf > 0), value / pdf, 0)

    def eval(self, ctx, si, wo, active=True):
        return self.both(si, wo, active)[0]

    def pdf(self, ctx, si, wo, active=True):
        return self.both(si, wo, active)[1]

    def eval_pdf(self, ctx, si, wo, active=True):
        return self.both(si, wo, active)

    def eval_diffuse_reflectance(self, si, active=True):
        return self.surface(si, active)[0]

    def to_string(self):
        return "GltfBsdf[]"


class AttenuatedBsdf(mi.BSDF):
    """A closed dielectric whose inside absorbs: light that arrives at it from within loses exp(-sigma t) on its way of t."""

    def __init__(self, props):
        mi.BSDF.__init__(self, props)
        self.inner = props["inner"]
        self.sigma = mi.Color3f(props["sigma"])
        self.m_components = [self.inner.flags(k) for k in range(self.inner.component_count())]
        self.m_flags = self.inner.flags()

    def factor(self, si):
        return dr.select(si.wi.z < 0, dr.exp(-self.sigma * si.t), 1)

    def sample(self, ctx, si, sample1, sample2, active=True):
        bs, value = self.inner.sample(ctx, si, sample1, sample2, active)
        return bs, value * self.factor(si)

    def eval(self, ctx, si, wo, active=True):
        return self.inner.eval(ctx, si, wo, active) * self.factor(si)

    def pdf(self, ctx, si, wo, active=True):
        return self.inner.pdf(ctx, si, wo, active)

    def eval_pdf(self, ctx, si, wo, active=True):
        value, pdf = self.inner.eval_pdf(ctx, si, wo, active)
        return value * self.factor(si), pdf

    def to_string(self):
        return "AttenuatedBsdf[]"


def register():
    mi.register_bsdf("gltf", GltfBsdf)
    mi.register_bsdf("attenuated", AttenuatedBsdf)
