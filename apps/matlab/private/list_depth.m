function depth = list_depth(key)
%LIST_DEPTH  How deep the lists of a key are: 0 of a number or word, 1 of a list, 2 of a list of points.
%   A scalar and a list of one number are the same to MATLAB, so the program's schema of scenes decides.
persistent schema
if isempty(schema)
    [folder, cleanup] = scratch_folder(); %#ok<ASGLU>
    schema = decode_json(call_program({'scenes', '--keys', '--json'}, cell(0, 3), folder));
end
depth = 0;
place = schema;
parts = field_path(key);
for k = 1:numel(parts)
    if ~isfield(place, 'properties') || ~isfield(place.properties, parts{k})
        return  % the program names an unknown key
    end
    place = place.properties.(parts{k});
end
while isfield(place, 'items')
    depth = depth + 1;
    place = place.items;
end
end
