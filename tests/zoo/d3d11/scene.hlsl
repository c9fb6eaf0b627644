// A room with cubes, in high dynamic range, and its tone mapping.

cbuffer Frame : register(b0)
{
    column_major float4x4 view_projection[2];
    uint4 eye;
};

cbuffer Object : register(b1)
{
    column_major float4x4 model;
    float4 colour;
};

struct Vertex
{
    float3 position : POSITION;
    float3 normal : NORMAL;
};

struct Fragment
{
    float4 place : SV_Position;
    float3 position : WORLD;
    float3 normal : NORMAL;
#ifdef INSTANCED
    uint layer : SV_RenderTargetArrayIndex;
#endif
};

#ifdef INSTANCED
Fragment scene_vertex(Vertex vertex, uint instance : SV_InstanceID)
#else
Fragment scene_vertex(Vertex vertex)
#endif
{
    Fragment result;
    float4 world = mul(model, float4(vertex.position, 1));
    result.position = world.xyz;
    result.normal = mul(model, float4(vertex.normal, 0)).xyz;
#ifdef INSTANCED
    result.layer = instance;
    result.place = mul(view_projection[instance], world);
#else
    result.place = mul(view_projection[eye.x], world);
#endif
    return result;
}

float4 scene_pixel(Fragment fragment) : SV_Target
{
    float3 normal = normalize(fragment.normal);
    float3 checks = frac(fragment.position);
    float odd = (checks.x < 0.5 ? 1 : 0) + (checks.y < 0.5 ? 1 : 0) + (checks.z < 0.5 ? 1 : 0);
    float shade = odd == 1 || odd == 3 ? 1.0 : 0.45;
    float light = 0.35 + 0.65 * saturate(dot(normal, float3(0.36, 0.8, 0.48)));
    float4 result;
    result.rgb = colour.rgb * shade * light * 1.6;
    result.a = 1;
    return result;
}

Texture2D<float4> drawn : register(t0);

float4 screen_vertex(uint vertex : SV_VertexID) : SV_Position
{
    float2 corner = float2(vertex == 1 ? 3 : -1, vertex == 2 ? -3 : 1);
    return float4(corner, 0, 1);
}

float4 tone_pixel(float4 place : SV_Position) : SV_Target
{
    float3 light = drawn.Load(int3(place.xy, 0)).rgb;
    return float4(light / (1 + 0.4 * light), 1);
}
